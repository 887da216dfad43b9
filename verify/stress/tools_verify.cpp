// Tools, meshes and blocks from any numbers: refused, or usable; and asked at any point.

#include "double_dome.hpp"
#include "dynamics/scenes.hpp"
#include "fuzz/properties.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace {

using namespace scenes;
using verify::claim;

constexpr double inf = std::numeric_limits<double>::infinity();

/// A number of the size of `typical`, one time in eight a special one.
double sized(verify::Random& random, double typical) {
  if (random.uniform(0, 1) < 0.875) return typical * random.log_uniform(0.3, 3);
  const auto& special = fuzz::special_numbers;
  const double x = special[static_cast<std::size_t>(random.uniform(0, special.size()))];
  return random.uniform(0, 1) < 0.7 ? x : -x;
}
/// Everywhere on and around a tool, one coordinate in eight anywhere.
Vec3<double> point(verify::Random& random, double size) {
  const auto coordinate = [&] {
    return sized(random, size) * (random.uniform(0, 1) < 0.5 ? -1 : 1);
  };
  const double x = coordinate(), y = coordinate(), z = coordinate();
  return {x, y, z};
}

/// Counts broken promises of a tool: gap and unit normal at every point within 1e150; beyond, where
/// squared distances are infinite, nothing touches without a unit normal; a NaN never touches. (An
/// infinite coordinate may touch, with a normal of NaN: its forces stop the run.)
template <class Shape>
long faults(const Shape& shape, const Vec3<double>& p) {
  const auto at = shape.gap(p);
  const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  const double length = detail::norm(at.normal);
  const bool unit = std::abs(length - 1) <= 1e-9;
  if (std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z)) return at.gap < 0;
  if (!(largest < inf)) return 0;
  return largest < 1e150 ? !std::isfinite(at.gap) || !unit : at.gap < 0 && !unit;
}

}  // namespace

TEST_SUITE_BEGIN("stress");

TEST_CASE("V-STRESS-05 a tool of any size is refused or answers at every point") {
  VERIFY_RANDOM(random, 7005);
  long broken = 0, asked = 0, refused = 0;
  const auto tool_of = [&](const char* name, int count, auto make) {
    for (int k = 0; k < count; ++k) {
      try {
        const auto shape = make();
        for (int q = 0; q < 20; ++q) {
          const Vec3<double> p = point(random, std::pow(10, random.uniform(-3, 3)));
          const long fault = faults(shape, p);
          const auto at = shape.gap(p);
          CHECK_MESSAGE(fault == 0, std::string(name), " at ", p.x, ", ", p.y, ", ", p.z, ": gap ",
                        at.gap, " normal ", at.normal.x, ", ", at.normal.y, ", ", at.normal.z);
          broken += fault;
          ++asked;
        }
      } catch (const InputError&) {
        ++refused;
      }
    }
  };
  const auto number = [&](double typical) { return sized(random, typical); };
  tool_of("plane", 2000,
          [&] { return Plane<double>(point(random, 10), point(random, 1), number(1)); });
  tool_of("sphere", 2000, [&] { return Sphere<double>(point(random, 10), number(10), number(1)); });
  tool_of("cylinder", 2000, [&] {
    return Cylinder<double>(point(random, 10), point(random, 1), number(10), number(1));
  });
  tool_of("ring", 2000, [&] {
    return StadiumRing<double>({number(90), number(100), number(5)}, number(1));
  });
  tool_of("dome", 2000, [&] {
    DoubleDomeParameters<double> p;
    for (double* x :
         {&p.depth, &p.dome_axis, &p.dome_radius, &p.dome_fillet, &p.ridge_flat, &p.ridge_edge,
          &p.ridge_fillet, &p.wall_angle, &p.blend_start, &p.blend_end, &p.blend_rounding})
      if (random.uniform(0, 1) < 0.15) *x = number(*x);
    return HeightSurface<DoubleDome<double>>(DoubleDome<double>(p, random.uniform(0, 2)),
                                             Side::above);
  });
  tool_of("table", 500, [&] {
    const double height = number(10), x0 = number(1), y0 = number(1);
    const HeightTableGrid<double> grid{x0,
                                       x0 + number(10),
                                       y0,
                                       y0 + number(10),
                                       number(0.5),
                                       random.uniform(0, 1) < 0.5,
                                       random.uniform(0, 1) < 0.5};
    if (grid.x1 - grid.x0 > 2000 * grid.spacing || grid.y1 - grid.y0 > 2000 * grid.spacing)
      throw InputError("this test", "table", "", "small tables");
    return HeightSurface<HeightTable<double>>(
        HeightTable<double>([&](double x, double) { return height * std::sin(x); }, grid),
        Side::below);
  });
  // On centres and edges, where no direction is better than another.
  const double tiny = std::numeric_limits<double>::denorm_min();
  for (const double d : {0.0, tiny, -tiny, 1e-200, 1e-161, -1e-160, 1e-100})
    for (const double e : {0.0, tiny, 1e-162, 1e-160}) {
      broken += faults(Sphere<double>({0, 0, 0}, 1), {d, e, 0});
      broken += faults(Cylinder<double>({0, 0, 0}, {0, 0, 1}, 1), {d, e, 5});
      const StadiumRing<double> ring;
      broken += faults(ring, {d, e, 5});
      broken += faults(ring, {275.0 / 3 + 5 - d, 0, e - 5});
      broken += faults(HeightSurface<DoubleDome<double>>(DoubleDome<double>(), Side::above),
                       {d, 100 + e, 60});
    }
  REQUIRE(asked > 100000);
  REQUIRE(refused > 500);
  claim("V-STRESS-05", static_cast<double>(broken), 0,
        "gaps that are NaN, normals that are no unit vectors, NaN points that touch");
  // A table that would fill the memory is refused before it does.
  CHECK_THROWS_AS(HeightTable<double>([](double, double) { return 0.0; },
                                      HeightTableGrid<double>{0, 1, 0, 1, 1e-4 / 1.5}),
                  InputError);
}

TEST_CASE("V-STRESS-06 meshes, masses and blocks from any numbers: refused, or finite") {
  VERIFY_RANDOM(random, 7006);
  long broken = 0, usable = 0, refused = 0, stopped = 0;
  for (int k = 0; k < 4000; ++k) {
    const double scale = k % 2 == 0 ? 1 : std::exp2(std::floor(random.uniform(-520, 520)));
    const auto number = [&](double typical) { return sized(random, typical); };
    std::string what;
    try {
      const double width = scale * number(10), length = scale * number(8);
      Points X;
      for (int i = 0; i <= 2; ++i)
        for (int j = 0; j <= 2; ++j) X.push_back({width * i / 2, length * j / 2, 0});
      if (k % 4 == 3) X[4] = scale * eigen(point(random, 1));
      const double turn = number(0.3), angle = random.uniform(0, 1) < 0.7 ? pi / 2 : number(1.2);
      const Mesh<4> m = mesh<4>(X, cells<4>(2, 2), turn, angle);
      const double mass = number(areal_mass);
      const double areas = [&] {
        double sum = 0;
        for (double A : m.tributary_areas()) sum += A;
        return sum;
      }();
      what = "areas " + std::to_string(areas);
      bool good = std::isfinite(areas) && areas > 0;
      for (const auto& f : m.fibres)
        good = good && std::abs(detail::norm(f.warp) - 1) < 1e-12 &&
               std::abs(detail::norm(f.weft) - 1) < 1e-12;
      NodalState<double> state(m, mass);
      const FibreAngle<double> fibre_angle(angle);
      const Woven<ConstantShear<double>> law{Cell(CellParameters<double>{}),
                                             ConstantShear<double>(number(1e-3)), fibre_angle};
      // Four elements and nine nodes leave lanes idle in every pack.
      using T = NativePack<double>;
      Model<real_t<T>> model(state, random.uniform(0, 1) < 0.7 ? 0 : number(0.1));
      model.add(std::make_unique<MembraneSweep<T, Quadrilateral<1>, decltype(law)>>(
          m, law, mass, MembraneOptions{number(1e-4), number(0.06)}));
      model.add(std::make_unique<BendingSweep<T>>(m, BendingStiffness{number(1e-3), 0.0}, mass));
      ContactParameters contact;
      contact.penalty = number(contact.penalty);
      contact.friction = number(contact.friction);
      model.add(tool<T>(Plane<double>({0, 0, -1e-6}, {0, 0, 1}), ToolMotion::fixed(), contact,
                        m.node_count));
      const double step = model.critical_step();
      CentralDifference<T> run(
          std::move(model),
          TimeStep::fixed(random.uniform(0, 1) < 0.8 ? 0.5 * step : number(1e-3)));
      for (int n = 0; n < m.node_count; ++n)
        run.state().v.set(n, 1e-3 * scale * vec3(random.vector(1)));
      EnergyLedger ledger;
      for (int s = 0; s < 10; ++s) run.step(&ledger);
      for (const auto& x : positions(run)) good = good && x.allFinite();
      good = good && std::isfinite(ledger.residual()) && step > 0;
      what += " step " + std::to_string(step) + " residual " + std::to_string(ledger.residual());
      CHECK_MESSAGE(good, "width ", width, " length ", length, " ", what);
      broken += !good;
      ++usable;
    } catch (const InputError&) {
      ++refused;
    } catch (const RunError& error) {
      const std::string text = error.what();
      const bool says_what = text.find("node ") != std::string::npos ||
                             text.find("ledger") != std::string::npos ||
                             text.find("no stiffness") != std::string::npos;
      CHECK_MESSAGE(says_what, text);
      broken += !says_what;
      ++stopped;
    }
  }
  CAPTURE(usable);
  CAPTURE(refused);
  CAPTURE(stopped);
  REQUIRE(usable > 300);
  REQUIRE(refused > 300);
  claim("V-STRESS-06", static_cast<double>(broken), 0,
        "models accepted that are not finite after ten steps, or stopped without saying why");

  // Stencils: any ring.
  long bad = 0, stencils = 0;
  for (int k = 0; k < 40000; ++k) {
    std::vector<StencilNeighbour> ring;
    const double scale = k % 2 == 0 ? 1 : std::exp2(std::floor(random.uniform(-1070, 1020)));
    const int count = static_cast<int>(random.uniform(0, 12));
    for (int n = 0; n < count; ++n) {
      const double a = random.uniform(0, 1) < 0.02 ? sized(random, inf) : random.uniform(-1, 1),
                   b = random.uniform(0, 1) < 0.4 ? 0 : random.uniform(-1, 1);
      ring.push_back({n, scale * a, scale * b});
    }
    for (const auto& weights : {three_point_difference(-1, ring), quadratic_difference(-1, ring)}) {
      stencils += !weights.empty();
      // Exact for the coordinate along the fibre and its square, or empty.
      double size = 0, first = 0, second = 0, round_off = 0;
      for (const auto& n : ring) size = std::max(size, std::hypot(n.along, n.across));
      for (const auto& w : weights) {
        const double s = w.id < 0 ? 0 : ring[static_cast<std::size_t>(w.id)].along / size;
        const double first_term = w.weight * size * s * size;
        first += first_term;
        second += first_term * s;
        round_off += 1e-12 * std::abs(first_term);
      }
      const bool good =
          weights.empty() || (std::abs(first) <= round_off && std::abs(second - 2) < 1e-6);
      CHECK_MESSAGE(good, "ring of ", count, " scale ", scale, ": ", first, " ", second);
      bad += !good;
    }
  }
  REQUIRE(stencils > 1000);
  claim("V-STRESS-06", static_cast<double>(bad), 0, "bending stencils that are not exact");
}

TEST_SUITE_END();
