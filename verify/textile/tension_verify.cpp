// Strips and cruciforms pulled along their yarns: whole meshes against the cell by bisection.

#include "support/claim.hpp"
#include "textile/independent_cell.hpp"
#include "textile/relaxation.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

namespace {

using namespace textile;
using Eigen::Vector3d;
using verify::claim;
using verify::Curve;
using verify::Plot;
using verify::show;
using verify::Worst;

constexpr double length = 20, width = 10;  // of the specimen, along x = warp and y = weft [mm]
constexpr double cell_length = 2.5;        // L of both yarns [mm]

Prescribed elongation(double strain) { return {Prescribed::What::elongation, strain * 2.5L}; }
Prescribed force(double f) { return {Prescribed::What::force, f}; }

/// Strains and tensions per width [kN/mm] of the cell, from its own yarns' ends.
struct Biaxial {
  double strain[2], tension[2];
  explicit Biaxial(const IndependentCell::Answer& a)
      : strain{double(a.u1) / cell_length, double(a.u2) / cell_length},
        tension{double(a.F1) / cell_length, double(a.F2) / cell_length} {}
};
Biaxial exact(const Prescribed& p1, const Prescribed& p2, const IndependentCell& cell = {}) {
  return Biaxial(cell.solve(p1, p2));
}

/// A sheet on rollers along x = 0 and y = 0, distorted inside, with straight sides. Opposite sides
/// are held by the clamps or free.
template <class Element>
struct Specimen {
  bool hold[2];
  Mesh<Element::corners> m;

  Specimen(verify::Random& random, bool hold_x, bool hold_y)
      : hold{hold_x, hold_y},
        m(mesh<Element::corners>(inner_distortion(4, 2, 5, 0.2, random),
                                 cells<Element::corners>(4, 2), 0, pi / 2)) {}

  [[nodiscard]] std::vector<int> side(int axis) const {
    const double at = axis == 0 ? length : width;
    return nodes_where(m, [&](const Vector3d& X) { return X[axis] == at; });
  }
  [[nodiscard]] std::vector<NodeConstraint> rollers() const {
    std::vector<NodeConstraint> out;
    for (int n = 0; n < m.node_count; ++n) {
      const auto X = m.nodes.get(n);
      out.push_back(
          {n, X.x == 0 || (hold[0] && X.x == length), X.y == 0 || (hold[1] && X.y == width), true});
    }
    return out;
  }
  [[nodiscard]] Points strained(const Biaxial& b) const {
    Points x;
    for (int n = 0; n < m.node_count; ++n) {
      const auto X = m.nodes.get(n);
      x.push_back({(1 + b.strain[0]) * X.x, (1 + b.strain[1]) * X.y, 0});
    }
    return x;
  }
  /// At rest under the given state, from 1 um beside it.
  template <class Law>
  [[nodiscard]] Model<double> model(const Law& law, const Biaxial& b,
                                    verify::Random& random) const {
    return sheet<Element>(m, law, rollers(), strained(b), random, 1e-3);
  }
  /// Dead load of a side [kN/mm], consistent: each node has half of the edges beside it.
  void load(Model<double>& model, int axis, double tension) const {
    for (int n : side(axis)) {
      double share = 0;
      for (const auto& [a, b] : border<Element::corners>(m.elements)) {
        const Vector3d A = eigen(m.nodes.get(a)), B = eigen(m.nodes.get(b));
        const double at = axis == 0 ? length : width;
        if ((a == n || b == n) && A[axis] == at && B[axis] == at) share += (B - A).norm() / 2;
      }
      const Vector3d f = tension * share * Vector3d::Unit(axis);
      model.add(std::make_unique<Pull>(std::vector<int>{n}, [f](double) { return f; }));
    }
  }
  /// Tension per reference width that the clamp measures.
  [[nodiscard]] double tension(const Run& run, int axis) const {
    return reaction(run, side(axis))[axis] / (axis == 0 ? width : length);
  }
};

/// Table 1 with other bending or contact. The shear modulus has no part in these tests.
Woven<ConstantShear<double>> fabric_with(double second_moment, double contact_modulus) {
  CellParameters<double> p;
  p.warp.second_moment_of_area = p.weft.second_moment_of_area = second_moment;
  p.contact_modulus = contact_modulus;
  return fabric(pi / 2, 0.02, p);
}

const double table_1_I = 1e-4, table_1_E3 = 1;
constexpr double N = 1000;  // newton in a kilonewton

std::vector<double> percent(std::vector<double> strains) {
  for (double& e : strains) e *= 100;
  return strains;
}

}  // namespace

TEST_SUITE_BEGIN("textile");

TEST_CASE("V-TEX-01 a strip pulled along its warp answers as a cell with a free weft") {
  VERIFY_RANDOM(random, 901);
  const std::vector<double> strains{0.005, 0.01, 0.012, 0.015, 0.02, 0.03};
  const std::vector<double> printed{9.4e-4, 3.8e-3, 8.9e-3, 0.0805, 0.2546, 0.604};  // [kN]
  Worst forces, contractions, even;
  Curve points{"mesh", percent(strains), {}, Curve::Style::points}, narrow = points;
  for (std::size_t k = 0; k < strains.size(); ++k) {
    const Biaxial b = exact(elongation(strains[k]), force(0));
    REQUIRE(b.tension[0] * cell_length == doctest::Approx(printed[k]).epsilon(6e-3));
    REQUIRE(std::abs(b.tension[1]) < 1e-15);
    REQUIRE(b.strain[1] < -strains[k]);  // crimp interchange, not a Poisson effect
    for_each_kind([&](auto kind) {
      using Element = typename decltype(kind)::Element;
      const Specimen<Element> strip(random, true, false);
      auto model = strip.model(fabric(pi / 2), b, random);
      const Run run = relax(std::move(model), 1e-10 * b.tension[0] * width);
      const double tension = strip.tension(run, 0);
      forces.see(std::abs(tension / b.tension[0] - 1), kind.name, strains[k]);
      for (const auto& s : samples(run)) {
        contractions.see(std::abs(s.stretch[1] - 1 - b.strain[1]), kind.name, strains[k]);
        even.see(std::abs(s.tension[1]) / b.tension[0], kind.name, strains[k]);
      }
      if (kind.name == OnePointKind::name) {
        points.y.push_back(N * tension);
        narrow.y.push_back(100 * (samples(run)[0].stretch[1] - 1));
      }
    });
  }
  // Fifteen nodes, each in equilibrium to 1e-10 of the force; the free weft's stiffness is down to
  // 1/500 of the warp's.
  forces.claim("V-TEX-01", 2e-9, "force of the strip, relative");
  contractions.claim("V-TEX-01", 1e-9, "strain of the weft in every element");
  even.claim("V-TEX-01", 2e-9, "tension of the free weft over that of the warp");

  // The toe is the yarns' bending and nothing else: at 0.5 % the force is proportional to I.
  std::vector<double> toe;
  for (double I : {1e-4, 0.5e-4, 0.25e-4}) {
    const Specimen<Quadrilateral<1>> strip(random, true, false);
    auto model =
        strip.model(fabric_with(I, table_1_E3), exact(elongation(0.005), force(0)), random);
    const Run run = relax(std::move(model), 1e-14);
    toe.push_back(strip.tension(run, 0));
  }
  for (std::size_t k = 0; k + 1 < toe.size(); ++k)
    // The next term: what the force itself stretches the yarn over what is left to the lock, 4e-3.
    claim("V-TEX-01", std::abs(std::log2(toe[k] / toe[k + 1]) - 1), 0.01,
          "order of the toe's force in the second moment of area, off 1");

  Curve curve{"cell by bisection", {}, {}, Curve::Style::line}, contraction = curve;
  for (double e = 0.001; e < 0.0302; e += 0.001) {
    const Biaxial b = exact(elongation(e), force(0));
    curve.x.push_back(100 * e);
    curve.y.push_back(N * b.tension[0]);
    contraction.x.push_back(100 * e);
    contraction.y.push_back(100 * b.strain[1]);
  }
  const double lock = std::hypot(2.5, 0.4) / 2.5 - 1, k_a = 35.4 / std::hypot(2.5, 0.4);
  const Curve ideal{"yarns without bending",
                    {0, 100 * lock, 3},
                    {0, 0, N * k_a * (0.03 - lock)},
                    Curve::Style::guide};
  show(Plot{"V-TEX-01",
            "Uniaxial tension of a strip",
            "strain of the warp [%]",
            "force per width [N/mm]",
            false,
            false,
            {curve, points, ideal},
            "Nearly free while the warp straightens at the weft's expense, up to 1.27 %; then the "
            "yarn itself is stretched. The mesh lies on the cell's curve."});
  show(Plot{"V-TEX-01",
            "Contraction of the strip",
            "strain of the warp [%]",
            "strain of the weft [%]",
            false,
            false,
            {contraction, narrow},
            "Crimp interchange: the free weft shortens up to three times as much as the warp is "
            "stretched, and no further once the warp is straight."});
}

TEST_CASE("V-TEX-02 a sheet pulled both ways has the forces of the cell at every ratio") {
  VERIFY_RANDOM(random, 902);
  Worst strain_driven, force_driven, inner;
  struct Ratio {
    const char* name;
    double e1, e2;
  };
  Curve mesh_points{"mesh", {}, {}, Curve::Style::points};
  for (const Ratio& r :
       {Ratio{"1:1", 1, 1}, Ratio{"1:2", 0.5, 1}, Ratio{"2:1", 1, 0.5}, Ratio{"1:0", 1, 0}})
    for (double strain : {0.001, 0.01, 0.02}) {
      const Biaxial b = exact(elongation(r.e1 * strain), elongation(r.e2 * strain));
      REQUIRE(std::min(b.tension[0], b.tension[1]) > 0);
      for_each_kind([&](auto kind) {
        using Element = typename decltype(kind)::Element;
        const Specimen<Element> cross(random, true, true);
        auto model = cross.model(fabric(pi / 2), b, random);
        const Run run = relax(std::move(model), 1e-11 * b.tension[0] * width);
        for (int axis : {0, 1})
          strain_driven.see(std::abs(cross.tension(run, axis) / b.tension[axis] - 1), kind.name,
                            r.name, strain, axis);
        for (const auto& s : samples(run))
          for (int i : {0, 1})
            inner.see(std::abs(s.tension[i] / b.tension[i] - 1), kind.name, r.name, strain, i);
        if (kind.name == OnePointKind::name) {
          mesh_points.x.push_back(100 * r.e1 * strain);
          mesh_points.y.push_back(N * cross.tension(run, 0));
        }
      });
    }
  // Residuals of 1e-11 at fifteen nodes; strains of 0.1 % from coordinates of 20 mm: 1e-12.
  strain_driven.claim("V-TEX-02", 1e-9, "forces at the sides at given strains, relative");
  inner.claim("V-TEX-02", 1e-9, "yarn tension of every element, relative");

  // Forces in the ratio 1:2, as a cruciform's load cells control them: the weft is stretched, the
  // warp hardly or not at all.
  Curve stretched{"weft, forces 1:2", {}, {}, Curve::Style::points};
  Curve shortened{"warp, forces 1:2", {}, {}, Curve::Style::points};
  for (double f : {0.02, 0.1, 0.4}) {
    const Biaxial b = exact(force(f / 2), force(f));
    REQUIRE(std::abs(b.tension[1] / b.tension[0] - 2) < 1e-12);
    for_each_kind([&](auto kind) {
      using Element = typename decltype(kind)::Element;
      const Specimen<Element> cross(random, false, false);
      auto model = cross.model(fabric(pi / 2), b, random);
      for (int axis : {0, 1}) cross.load(model, axis, b.tension[axis]);
      const Run run = relax(std::move(model), 1e-11 * b.tension[0] * width);
      for (const auto& s : samples(run))
        for (int i : {0, 1})
          force_driven.see(std::abs(s.stretch[i] - 1 - b.strain[i]), kind.name, f, i);
    });
    stretched.x.push_back(100 * b.strain[1]);
    stretched.y.push_back(N * b.tension[1]);
    shortened.x.push_back(100 * b.strain[0]);
    shortened.y.push_back(N * b.tension[0]);
  }
  force_driven.claim("V-TEX-02", 1e-10, "strains at given forces in the ratio 1:2");

  // Balanced tension on a rigid contact: two frozen triangles (V-CELL-07). The contact's own
  // shortening vanishes like 1/E3.
  constexpr double strain = 0.01;
  const double L = 2.5, H = 0.4, l0 = std::hypot(L, H), l = std::hypot(L * (1 + strain), H);
  const double k_a = 35.4 / l0, k_b = 3 * 35.4e-4 / (l0 * l0 * l0);
  const double rigid =
      (k_a * (l - l0) * L * (1 + strain) / l + k_b * (H / l0) * (H / l0) * strain * L) / L;
  std::vector<double> off;
  for (double E3 : {10.0, 20.0, 40.0, 1e14}) {
    const Specimen<Quadrilateral<1>> cross(random, true, true);
    auto model = cross.model(fabric_with(table_1_I, E3),
                             exact(elongation(strain), elongation(strain)), random);
    const Run run = relax(std::move(model), 1e-12);
    off.push_back(std::abs(cross.tension(run, 0) / rigid - 1));
  }
  claim("V-TEX-02", off[3], 1e-10, "balanced tension on a rigid contact, relative");
  for (std::size_t k : {0u, 1u})
    // The next term is k_hh/(2 k3) = 1e-3.
    claim("V-TEX-02", std::abs(std::log2(off[k] / off[k + 1]) - 1), 0.01,
          "order in 1/E3 of the distance from the rigid contact, off 1");

  std::vector<Curve> curves;
  for (const Ratio& r : {Ratio{"strains 1:1", 1, 1}, Ratio{"strains 1:0.5", 1, 0.5},
                         Ratio{"strains 1:0", 1, 0}, Ratio{"strains 0.5:1", 0.5, 1}}) {
    Curve c{r.name, {}, {}, Curve::Style::line};
    for (double e = 0.0002; e * r.e1 <= 0.0201; e += 0.0004) {
      c.x.push_back(100 * e * r.e1);
      c.y.push_back(N * exact(elongation(r.e1 * e), elongation(r.e2 * e)).tension[0]);
    }
    curves.push_back(c);
  }
  curves.push_back(mesh_points);
  show(Plot{"V-TEX-02", "Biaxial tension at given strain ratios", "strain of the warp [%]",
            "force per width along the warp [N/mm]", false, false, curves,
            "The less the weft is stretched, the longer the warp can straighten; the mesh lies on "
            "the cell's curves."});
  Curve weft{"weft, forces 1:2, cell by bisection", {}, {}, Curve::Style::line};
  Curve warp{"warp, forces 1:2, cell by bisection", {}, {}, Curve::Style::line};
  for (double f = 0.01; f < 0.42; f += 0.02) {
    const Biaxial b = exact(force(f / 2), force(f));
    weft.x.push_back(100 * b.strain[1]);
    weft.y.push_back(N * b.tension[1]);
    warp.x.push_back(100 * b.strain[0]);
    warp.y.push_back(N * b.tension[0]);
  }
  show(Plot{"V-TEX-02",
            "Biaxial tension at forces 1:2",
            "strain [%]",
            "force per width [N/mm]",
            false,
            false,
            {weft, stretched, warp, shortened},
            "Pulled half as hard, the warp shortens at first: the weft takes its crimp."});
}

TEST_SUITE_END();
