// Parameters outside their range are refused, each by its name, its value and the range.

#include "cell/states.hpp"
#include "crossbeam/cell/second_order.hpp"

#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

TEST_SUITE_BEGIN("cell");

TEST_CASE("V-CELL-22 bad parameters are refused by name, value, unit and range") {
  using verify::Parameters;
  struct Field {
    std::string name, unit;
    std::function<double&(Parameters&)> value;
    bool zero_allowed;
  };
  const auto yarn = [](const std::string& name, auto which) {
    return std::vector<Field>{
        {name + ".youngs_modulus", "kN/mm^2",
         [=](Parameters& p) -> double& { return which(p).youngs_modulus; }, false},
        {name + ".cross_section", "mm^2",
         [=](Parameters& p) -> double& { return which(p).cross_section; }, false},
        {name + ".second_moment_of_area", "mm^4",
         [=](Parameters& p) -> double& { return which(p).second_moment_of_area; }, true},
        {name + ".length", "mm", [=](Parameters& p) -> double& { return which(p).length; }, false}};
  };
  std::vector<Field> fields = yarn("fabric.warp", [](Parameters& p) -> auto& { return p.warp; });
  for (const Field& f : yarn("fabric.weft", [](Parameters& p) -> auto& { return p.weft; }))
    fields.push_back(f);
  fields.push_back({"fabric.contact_modulus", "kN/mm^2",
                    [](Parameters& p) -> double& { return p.contact_modulus; }, false});
  fields.push_back({"fabric.contact_area", "mm^2",
                    [](Parameters& p) -> double& { return p.contact_area; }, false});
  fields.push_back({"fabric.contact_length", "mm",
                    [](Parameters& p) -> double& { return p.contact_length; }, false});
  fields.push_back({"fabric.warp_height_fraction", "-",
                    [](Parameters& p) -> double& { return p.warp_height_fraction; }, false});
  fields.push_back({"fabric.bending_boundary_factor", "-",
                    [](Parameters& p) -> double& { return p.bending_boundary_factor; }, false});
  fields.push_back({"fabric.residual_compression_stiffness", "kN/mm",
                    [](Parameters& p) -> double& { return p.residual_compression_stiffness; },
                    true});

  int asked = 0, refused = 0;
  const auto must_refuse = [&](const Parameters& p, const Field& field, const std::string& value) {
    ++asked;
    CAPTURE(field.name);
    CAPTURE(value);
    try {
      crossbeam::validate(p, "fabric");
      FAIL_CHECK("was accepted");
    } catch (const crossbeam::InputError& error) {
      const std::string what = error.what();
      CAPTURE(what);
      const bool names_it = error.field() == field.name;
      const bool shows_it = what.find(field.name + " = " + value + " [" + field.unit + "]") == 0;
      const bool gives_range = what.find("is not admissible: ") != std::string::npos;
      CHECK(names_it);
      CHECK(shows_it);
      CHECK(gives_range);
      refused += names_it && shows_it && gives_range;
    }
    // Constructing a cell is refused as well.
    CHECK_THROWS_AS(verify::Cell{p}, crossbeam::InputError);
    CHECK_THROWS_AS(crossbeam::BilateralCell<double>{p}, crossbeam::InputError);
    CHECK_THROWS_AS(crossbeam::SecondOrderCell<double>{p}, crossbeam::InputError);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const Field& field : fields) {
    const auto with = [&](double value) {
      Parameters p = verify::table_1();
      field.value(p) = value;
      return p;
    };
    CHECK_NOTHROW(crossbeam::validate(with(0.25), "fabric"));
    must_refuse(with(-1), field, "-1");
    must_refuse(with(nan), field, "nan");
    must_refuse(with(inf), field, "inf");
    must_refuse(with(-inf), field, "-inf");
    if (field.zero_allowed)
      CHECK_NOTHROW(crossbeam::validate(with(0), "fabric"));
    else
      must_refuse(with(0), field, "0");
  }
  Parameters whole = verify::table_1();
  whole.warp_height_fraction = 1;
  CHECK_THROWS_AS(crossbeam::validate(whole), crossbeam::InputError);
  for (const int symmetry : {-1, 0, 3}) {
    Parameters p = verify::table_1();
    p.symmetry = symmetry;
    try {
      crossbeam::validate(p);
      FAIL_CHECK("symmetry " << symmetry << " was accepted");
    } catch (const crossbeam::InputError& error) {
      CHECK(error.field() == "cell.symmetry");
      CHECK(std::string(error.what()).find("1 or 2") != std::string::npos);
    }
  }
  for (const double kappa : {0.0, -1.0, nan, inf}) {
    try {
      crossbeam::SecondOrderCell<double> cell(verify::table_1(), kappa);
      FAIL_CHECK("kappa " << kappa << " was accepted");
    } catch (const crossbeam::InputError& error) {
      CHECK(error.field() == "cell.string_factor");
    }
  }
  // A count: every one of them or the claim is false.
  REQUIRE(asked == 14 * 4 + 11);
  verify::claim("V-CELL-22", asked - refused, 0, "bad values that were not refused by name");
}

TEST_SUITE_END();
