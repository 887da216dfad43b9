// Triangle and quadrilaterals on distorted patches with fibres skew to every edge. The independent
// side of the patch test knows no shape function: a constant first Piola-Kirchhoff stress P loads
// the border of a patch with P N per length and leaves its inside in equilibrium.

#include "crossbeam/base/dual.hpp"
#include "element/manufactured_load.hpp"
#include "element/patches.hpp"
#include "support/claim.hpp"
#include "support/plots.hpp"
#include "support/taylor_test.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>

#include <string>

namespace {

using namespace patches;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using verify::claim;
using verify::Worst;

constexpr double warp_angle = 0.4, fibre_angle = 1.2;  // [rad]; skew to the edges and to each other
constexpr int nx = 5, ny = 4;
constexpr double edge = 3, distortion = 0.25;  // at most 0.25: every corner stays convex

template <class Kind>
constexpr int corners_of = Kind::Element::corners;

template <class Kind, class Law>
auto sweep_of(const Mesh<corners_of<Kind>>& m, const Law& law,
              const MembraneOptions& options = {}) {
  return MembraneSweep<Lane, typename Kind::Element, Law>(m, law, areal_mass, options);
}

}  // namespace

TEST_SUITE_BEGIN("element");
TEST_CASE(
    "V-ELEM-01 patch test: an affine map stresses every element as the law says and leaves "
    "inner nodes in equilibrium") {
  VERIFY_RANDOM(random, 101);
  Worst forces, angles, stretches, tensions;
  const auto law = fabric(fibre_angle);
  for_each_kind([&](auto kind) {
    using Kind = decltype(kind);
    constexpr int corners = corners_of<Kind>;
    CAPTURE(std::string(Kind::name));
    for (int sample = 0; sample < 20; ++sample) {
      const Matrix3d Q = random.rotation();
      REQUIRE(is_rotation(Q));
      const auto m = mesh<corners>(grid(nx, ny, edge, distortion, random), cells<corners>(nx, ny),
                                   warp_angle, fibre_angle, Q);
      REQUIRE(std::abs(m.area(0) / m.area(1) - 1) > 1e-3);  // a distorted mesh
      const Matrix3d A = random.rotation() * (Matrix3d::Identity() + random_matrix(random, 0.04));
      const Vector3d b = random.vector(100);
      Points x;
      for (int n = 0; n < m.node_count; ++n) x.push_back(A * eigen(m.nodes.get(n)) + b);

      // The law at the strain of the map, in the axes Y1 = warp, Y2 square to it.
      Base<double> Y;
      Y.col(0) = Q * direction(warp_angle);
      Y.col(1) = Q * direction(warp_angle + pi / 2);
      const Base<double> F = A * Y;
      const Matrix2<double> E = (F.transpose() * F - Matrix2<double>::Identity()) / 2;
      REQUIRE(E.norm() > 1e-3);
      const auto response = membrane_response(law, E);
      REQUIRE(response.status == CellStatus::converged);
      const Points expected = border_forces(m, F * response.S, Y);

      auto sweep = sweep_of<Kind>(m, law, {0.01, 0});
      auto state = state_at(m, x);
      const Points measured = gradient(sweep, state);
      REQUIRE(largest(expected) > 0);
      const double scale = 14 * edge * E.norm();  // forces of straight yarns at this strain
      int inner = 0;
      for (int n = 0; n < m.node_count; ++n) {
        inner += expected[n].norm() == 0;
        forces.see((measured[n] - expected[n]).norm() / scale, Kind::name, sample, "node", n);
      }
      REQUIRE(inner == (nx - 1) * (ny - 1));

      const Vector3d f1 = A * eigen(m.fibres[0].warp), f2 = A * eigen(m.fibres[0].weft);
      const double gamma = fibre_angle - std::atan2(f1.cross(f2).norm(), f1.dot(f2));
      // Eq. 15: tension per width across the yarn, from the force of the cell at this elongation.
      const auto cell = law.cell().solve(2.5 * (f1.norm() - 1), 2.5 * (f2.norm() - 1));
      std::vector<ElementSample> elements;
      sweep.sample(state, elements);
      REQUIRE(static_cast<int>(elements.size()) == m.element_count());
      for (const auto& e : elements) {
        angles.see(std::abs(e.shear_angle - gamma), Kind::name, sample);
        stretches.see(std::abs(e.stretch[0] - f1.norm()), Kind::name, sample);
        stretches.see(std::abs(e.stretch[1] - f2.norm()), Kind::name, sample);
        const double width = 2.5 * std::sin(fibre_angle);
        tensions.see(std::abs(e.tension[0] - cell.forces.F1 / width), Kind::name, sample);
        tensions.see(std::abs(e.tension[1] - cell.forces.F2 / width), Kind::name, sample);
      }
    }
  });
  // A fibre strain of order 0.02 is a difference of numbers of order 1, and its nodes lie 100 mm
  // away on 3 mm elements: relative rounding 1e-16 * (100/3) / 0.02 = 2e-13, a few of them added.
  forces.claim("V-ELEM-01", 2e-12,
               "nodal forces against border tractions, over those of taut yarns");
  // Coordinates of 100 mm round to 1e-14 mm, on edges of 3 mm; two of them per gradient.
  angles.claim("V-ELEM-01", 5e-14, "shear angle [rad]");
  stretches.claim("V-ELEM-01", 5e-14, "yarn stretches");
  // That strain error times the straight yarn's 15 kN/mm.
  tensions.claim("V-ELEM-01", 1e-12, "yarn tensions [kN/mm]");

  // Beyond affine maps: the fibre vectors at each point are the derivatives of the bilinear map
  // there and the weights its area, both from positions on the element alone, anywhere in space.
  Worst fibres, weights;
  const auto at_points = [&](auto element) {
    using Element = decltype(element);
    for (int sample = 0; sample < 50; ++sample) {
      const Matrix3d Q = random.rotation();
      const Vector3d offset = random.vector(20);
      std::array<Vector3d, 4> X, x;
      const double corner[4][2] = {{0, 0}, {3, 0}, {3, 3}, {0, 3}};
      for (int a = 0; a < 4; ++a) {
        const Vector3d in_plane(corner[a][0] + random.uniform(-0.5, 0.5),
                                corner[a][1] + random.uniform(-0.5, 0.5), 0);
        X[a] = Q * in_plane + offset;
        x[a] = X[a] + random.vector(0.5);
      }
      const FibreDirections<double> directions{vec3(Q * direction(warp_angle)),
                                               vec3(Q * direction(warp_angle + fibre_angle))};
      const auto at = [](const std::array<Vector3d, 4>& p, double xi, double eta) -> Vector3d {
        return ((1 - xi) * (1 - eta) * p[0] + (1 + xi) * (1 - eta) * p[1] +
                (1 + xi) * (1 + eta) * p[2] + (1 - xi) * (1 + eta) * p[3]) /
               4;
      };
      std::array<Vec3<double>, 4> corners, now;
      for (int a = 0; a < 4; ++a) {
        corners[a] = vec3(X[a]);
        now[a] = vec3(x[a]);
      }
      Vec3<double> D[Element::vectors];
      const Vec3<double> moved[4] = {now[0], now[1], now[2], now[3]};
      Element::relative_vectors(moved, D);
      const auto points = Element::coefficients(corners, directions);
      for (int p = 0; p < Element::points; ++p) {
        const double g = Element::points == 1 ? 0 : 1 / std::sqrt(3.0);
        const double xi = p % 2 == 0 ? -g : g, eta = p / 2 == 0 ? -g : g;
        // A bilinear map is linear along each coordinate: differences are derivatives.
        const auto tangents = [&](const std::array<Vector3d, 4>& c) {
          Eigen::Matrix<double, 3, 2> J;
          J.col(0) = (at(c, 1, eta) - at(c, -1, eta)) / 2;
          J.col(1) = (at(c, xi, 1) - at(c, xi, -1)) / 2;
          return J;
        };
        const Eigen::Matrix<double, 3, 2> J = tangents(X), j = tangents(x);
        const double area = J.col(0).cross(J.col(1)).norm() * (Element::points == 1 ? 4 : 1);
        weights.see(std::abs(points[p].weight / area - 1), sample, p);
        const auto see = [&](const auto& t, const Vec3<double>& F) {
          const Vector3d expected =
              j * ((J.transpose() * J).inverse() * (J.transpose() * eigen(F)));
          Vector3d f = Vector3d::Zero();
          for (int k = 0; k < Element::membrane_vectors; ++k) f += t[k] * eigen(D[k]);
          fibres.see((f - expected).norm(), sample, p);
        };
        see(points[p].t1, directions.warp);
        see(points[p].t2, directions.weft);
      }
    }
  };
  // Far from the origin nothing is lost that the coordinates have: these are exact.
  const auto far_away = [&](auto element) {
    using Element = decltype(element);
    const double shape[4][2] = {{0, 0}, {3.25, 0.5}, {3, 2.75}, {-0.25, 3}};
    std::array<Vec3<double>, 4> near, far;
    for (int a = 0; a < 4; ++a) {
      near[a] = {shape[a][0], shape[a][1], 0};
      far[a] = {0x1p24 + shape[a][0], shape[a][1] - 0x1p25, 0x1p22};
    }
    const FibreDirections<double> directions{vec3(direction(warp_angle)),
                                             vec3(direction(warp_angle + fibre_angle))};
    const auto here = Element::coefficients(near, directions);
    const auto there = Element::coefficients(far, directions);
    for (int p = 0; p < Element::points; ++p) {
      weights.see(std::abs(there[p].weight / here[p].weight - 1), "far away", p);
      for (int k = 0; k < Element::vectors; ++k)
        fibres.see(
            std::abs(there[p].t1[k] - here[p].t1[k]) + std::abs(there[p].t2[k] - here[p].t2[k]),
            "far away", p);
    }
  };
  far_away(Quadrilateral<1>{});
  far_away(Quadrilateral<4>{});
  at_points(Quadrilateral<1>{});
  at_points(Quadrilateral<4>{});
  // Coordinates of 20 mm round to 4e-15 mm, over edges of 3 mm and flat corners.
  fibres.claim("V-ELEM-01", 1e-13,
               "fibre vectors at the points of quadrilaterals, non-affine maps");
  weights.claim("V-ELEM-01", 1e-13, "areas of the points of quadrilaterals");
}

TEST_CASE("V-ELEM-02 rigid motions change neither energy nor shear angle, and forces turn along") {
  VERIFY_RANDOM(random, 102);
  Worst energies, angles, turned, at_rest;
  const auto law = fabric(fibre_angle);
  for_each_kind([&](auto kind) {
    using Kind = decltype(kind);
    constexpr int corners = corners_of<Kind>;
    const Points X = grid(nx, ny, edge, distortion, random);
    const auto m = mesh<corners>(X, cells<corners>(nx, ny), warp_angle, fibre_angle);
    auto sweep = sweep_of<Kind>(m, law, {0.01, 0});
    for (int sample = 0; sample < 10; ++sample) {
      const Matrix3d Q = random.rotation();
      REQUIRE(is_rotation(Q));
      const Vector3d b = random.vector(50);

      auto resting = state_at(m, map(X, Q, b));
      at_rest.see(largest(gradient(sweep, resting)), Kind::name, sample);

      Points x = X;
      for (auto& p : x) p += random.vector(0.1);
      auto before = state_at(m, x), after = state_at(m, map(x, Q, b));
      const double W = energy(sweep, before);
      REQUIRE(W > 1e-3);
      energies.see(std::abs(energy(sweep, after) - W) / W, Kind::name, sample);
      const Points f = gradient(sweep, before), g = gradient(sweep, after);
      for (int n = 0; n < m.node_count; ++n)
        turned.see((g[n] - Q * f[n]).norm() / largest(f), Kind::name, sample);
      std::vector<ElementSample> s, t;
      sweep.sample(before, s);
      sweep.sample(after, t);
      for (std::size_t e = 0; e < s.size(); ++e) {
        REQUIRE(std::abs(s[e].shear_angle) < 0.5);
        angles.see(std::abs(s[e].shear_angle - t[e].shear_angle), Kind::name, sample);
      }
    }
  });
  // Strains of order 0.03 from coordinates of 50 mm on 3 mm edges: 1e-16 * 17 / 0.03 = 6e-14.
  energies.claim("V-ELEM-02", 1e-12, "energy, relative");
  turned.claim("V-ELEM-02", 2e-12, "forces, relative");
  angles.claim("V-ELEM-02", 5e-14, "shear angle [rad]");
  // Strain rounding 17 * 2e-16 times 14 kN/mm times the 3 mm of an edge, times 4 to 6 elements.
  at_rest.claim("V-ELEM-02", 2e-12, "forces of the unstrained patch, turned and moved [kN]");
}

TEST_CASE("V-ELEM-03 nodal forces are minus the gradient of the energy") {
  VERIFY_RANDOM(random, 103);
  Worst slopes;
  double mutated = 1e9;
  const auto law = fabric(fibre_angle);
  for_each_kind([&](auto kind) {
    using Kind = decltype(kind);
    constexpr int corners = corners_of<Kind>;
    const Points X = grid(nx, ny, edge, distortion, random);
    const auto m = mesh<corners>(X, cells<corners>(nx, ny), warp_angle, fibre_angle);
    auto sweep = sweep_of<Kind>(m, law, {0.3, 0});  // an hourglass modulus that matters here
    for (int sample = 0; sample < 5; ++sample) {
      Points x = X, h = X;
      for (std::size_t n = 0; n < x.size(); ++n) {
        x[n] += random.vector(0.15);
        h[n] = random.vector(1);
      }
      auto state = state_at(m, x);
      EnergyLedger parts;
      sweep.add_energy(state, parts);
      REQUIRE(parts.value("yarn") > 1e-3);
      REQUIRE(parts.value("shear") > 1e-4);
      REQUIRE((parts.value("hourglass") > 1e-3) == Kind::Element::has_hourglass);
      const Points g = gradient(sweep, state);
      double slope = 0;
      for (std::size_t n = 0; n < g.size(); ++n) slope += g[n].dot(h[n]);
      REQUIRE(std::abs(slope) > 1e-3);
      const double W = parts.stored();
      const auto remainder = [&](double factor) {
        return [&, factor](double eps) {
          Points y = x;
          for (std::size_t n = 0; n < y.size(); ++n) y[n] += eps * h[n];
          return energy(sweep, state_at(m, y)) - W - eps * factor * slope;
        };
      };
      const auto result = verify::taylor_test(2, remainder(1), 1e-4, 1e-13 * W);
      INFO(Kind::name, result.table);
      slopes.see(result.deviation, Kind::name, sample);
      mutated =
          std::min(mutated, verify::taylor_test(2, remainder(1.01), 1e-4, 1e-13 * W).deviation);
    }
  });
  // Over four halvings the next term, of relative size eps, is left: below 0.01 for eps < 1e-4.
  slopes.claim("V-ELEM-03", 0.01, "deviation from Taylor slope 2");
  // Forces wrong by a hundredth must show, or this test could not fail.
  claim("V-ELEM-03", mutated, 0.1, "the same with a gradient that is 1 % wrong",
        verify::Bound::lower);
}

TEST_CASE("V-ELEM-04 the forces of a patch sum to zero and have no moment") {
  VERIFY_RANDOM(random, 104);
  Worst sums, moments;
  const auto law = fabric(fibre_angle);
  for_each_kind([&](auto kind) {
    using Kind = decltype(kind);
    constexpr int corners = corners_of<Kind>;
    const Points X = grid(nx, ny, edge, distortion, random);
    const auto m = mesh<corners>(X, cells<corners>(nx, ny), warp_angle, fibre_angle);
    auto sweep = sweep_of<Kind>(m, law, {0.3, 0});
    for (int sample = 0; sample < 10; ++sample) {
      Points x = X;
      for (auto& p : x) p += random.vector(0.3);
      auto state = state_at(m, x);
      const Points f = gradient(sweep, state);
      Vector3d sum = Vector3d::Zero(), moment = Vector3d::Zero();
      for (std::size_t n = 0; n < f.size(); ++n) {
        sum += f[n];
        moment += x[n].cross(f[n]);
      }
      REQUIRE(largest(f) > 1e-3);
      sums.see(sum.norm() / largest(f), Kind::name, sample);
      moments.see(moment.norm() / (largest(f) * nx * edge), Kind::name, sample);
    }
  });
  // 30 nodes with four to six corner forces each, every one rounded once: 200 * 1e-16, and less
  // because the signs are random.
  sums.claim("V-ELEM-04", 1e-14, "sum of the forces over the largest");
  moments.claim("V-ELEM-04", 1e-14, "moment over the largest force times the patch's length");
}

TEST_CASE(
    "V-ELEM-05 hourglass control sees no affine field, stops the hourglass and nothing else") {
  VERIFY_RANDOM(random, 105);
  Worst affine, square;
  for (int sample = 0; sample < 100; ++sample) {
    const Points X = grid(1, 1, edge, distortion, random);
    const auto m = mesh<4>(X, cells<4>(1, 1), 0, pi / 2, random.rotation());
    auto sweep = sweep_of<OnePointKind>(m, LinearLaw<double>{}, {1.0, 0});
    const Matrix3d A = Matrix3d::Identity() + random_matrix(random, 0.3);
    Points x;
    for (int n = 0; n < 4; ++n) x.push_back(A * eigen(m.nodes.get(n)));
    EnergyLedger e;
    sweep.add_energy(state_at(m, x), e);
    // q^2 / 2 is this energy up to a factor of order 1; q is a rounding of 3 mm.
    affine.see(std::sqrt(e.value("hourglass")), sample);
  }
  affine.claim("V-ELEM-05", 1e-14, "hourglass amplitude of affine fields [mm]");

  // On a square of any size, corners that go up and down by a store k a^2: the amplitude is 4 a
  // and the stiffness k/8 by [E-4].
  for (double side : {0.1, 3.0, 50.0}) {
    const auto m = rectangle(side, side, 1, 1);
    auto sweep = sweep_of<OnePointKind>(m, LinearLaw<double>{}, {0.7, 0});
    const double a = 0.01 * side;
    const Vector3d way = random.rotation().col(0);
    Points x;
    for (int n = 0; n < 4; ++n)
      x.push_back(eigen(m.nodes.get(n)) + (n == 0 || n == 3 ? a : -a) * way);
    EnergyLedger e;
    sweep.add_energy(state_at(m, x), e);
    square.see(std::abs(e.value("hourglass") / (0.7 * a * a) - 1), side);
    REQUIRE(e.value("yarn") + e.value("shear") <
            1e-20 * side * side);  // the point itself sees nothing of it
  }
  square.claim("V-ELEM-05", 1e-12,
               "hourglass energy of a square, relative");  // rounding of a/side

  // 2x2 points integrate the in-plane hourglass u = a xi eta of a square exactly:
  // (2/3) (C + G) a^2 while strains are small.
  const auto whole = rectangle(edge, edge, 1, 1);
  auto four = sweep_of<FourPointKind>(whole, LinearLaw<double>{});
  const double a = 1e-5 * edge;
  Points x;
  for (int n = 0; n < 4; ++n)
    x.push_back(eigen(whole.nodes.get(n)) + Vector3d(n == 0 || n == 3 ? a : -a, 0, 0));
  const double expected = (LinearLaw<double>{}.C + LinearLaw<double>{}.G) * 2 / 3 * a * a;
  // The next term of the strain is of relative size a/edge, its square counts; strains of 1e-5
  // keep ten digits.
  claim("V-ELEM-05", std::abs(energy(four, state_at(whole, x)) / expected - 1), 1e-8,
        "energy of the hourglass at 2x2 points against its integral, relative");

  // Modes without energy of one unstressed element: a flat membrane has the six rigid motions;
  // 2x2 points leave it the hourglass out of the plane, one point all three.
  const auto zero_modes = [&](auto kind, double modulus, int count) {
    using Kind = decltype(kind);
    constexpr int corners = corners_of<Kind>;
    const Points X = grid(1, 1, edge, distortion, random);
    std::vector<std::array<int, corners>> one{cells<corners>(1, 1)[0]};
    Points used;
    for (int n = 0; n < corners; ++n) {
      used.push_back(X[one[0][n]]);
      one[0][n] = n;
    }
    const auto m = mesh<corners>(used, one, warp_angle, pi / 2);
    auto sweep = sweep_of<Kind>(m, LinearLaw<double>{}, {modulus, 0});
    constexpr int size = 3 * corners;
    Eigen::Matrix<double, size, size> K;
    // Forces are cubic in the displacements: this difference is wrong by eps^2 = 1e-8 and rounded
    // to 1e-12, both relative.
    constexpr double eps = 1e-4;
    for (int c = 0; c < size; ++c) {
      Points plus = used, minus = used;
      plus[c / 3][c % 3] += eps;
      minus[c / 3][c % 3] -= eps;
      auto p = state_at(m, plus), q = state_at(m, minus);
      const Points fp = gradient(sweep, p), fm = gradient(sweep, q);
      for (int r = 0; r < size; ++r) K(r, c) = (fp[r / 3][r % 3] - fm[r / 3][r % 3]) / (2 * eps);
    }
    const Eigen::FullPivLU<decltype(K)> lu(K);
    int zeros = 0;
    for (int k = 0; k < size; ++k) {
      const double pivot = std::abs(lu.matrixLU()(k, k));
      REQUIRE((pivot < 1e-6 || pivot > 1e-3));  // a clear gap
      zeros += pivot < 1e-6;
    }
    CAPTURE(std::string(Kind::name));
    CAPTURE(modulus);
    CHECK(zeros == count);
    return std::abs(zeros - count);
  };
  const int wrong = zero_modes(TriangleKind{}, 0, 6) + zero_modes(OnePointKind{}, 0, 9) +
                    zero_modes(OnePointKind{}, 0.1, 6) + zero_modes(FourPointKind{}, 0, 7);
  claim("V-ELEM-05", wrong, 0, "zero-energy modes more or fewer than 6, 9, 6, 7");
}

TEST_CASE("V-ELEM-10 the bound of the step knows the hourglass stiffness") {
  VERIFY_RANDOM(random, 110);
  Worst alone, share;
  const LinearLaw<double> law;
  for (const double side : {0.1, 3.0, 50.0})
    for (const bool distorted : {false, true}) {
      CAPTURE(side);
      const Points X = grid(1, 1, side, distorted ? distortion : 0, random);
      const auto m = mesh<4>(X, cells<4>(1, 1), 0.4, pi / 2);
      const auto bound = [&](double modulus) {
        return sweep_of<OnePointKind>(m, law, {modulus, 0}).omega_squared();
      };
      // The hourglass is what no affine field is: orthogonal to 1, x and y over the corners. Out
      // of the plane no yarn feels it, and its squared frequency is 2 W / sum m u^2.
      Eigen::Matrix<double, 3, 4> affine;
      for (int n = 0; n < 4; ++n) affine.col(n) = Vector3d(1, X[n].x(), X[n].y());
      const Eigen::Vector4d u = Eigen::FullPivLU<decltype(affine)>(affine).kernel().col(0);
      constexpr double modulus = 1e3;
      auto sweep = sweep_of<OnePointKind>(m, law, {modulus, 0});
      Points x = X;
      for (int n = 0; n < 4; ++n) x[n].z() += 1e-2 * side * u[n];
      EnergyLedger e;
      sweep.add_energy(state_at(m, x), e);
      const double mass = areal_mass * m.area(0) / 4;
      const double hourglass =
          2 * e.value("hourglass") / (mass * 1e-4 * side * side * u.squaredNorm());
      // In a square the hourglass is a mode of its own.
      if (!distorted) alone.see(std::abs(bound(modulus) / hourglass - 1), side);
      // The sum of two stiffnesses has a frequency between the higher one and the sum of both.
      CHECK(bound(modulus) >= hourglass * (1 - 1e-12));
      CHECK(bound(modulus) <= (hourglass + bound(0)) * (1 + 1e-12));
      share.see(bound(0) / hourglass, side);
    }
  share.claim("V-ELEM-10", 0.1, "bound without hourglass control over the hourglass's frequency");
  alone.claim("V-ELEM-10", 1e-12, "bound of a square against the frequency of its hourglass mode");
}

TEST_CASE("V-ELEM-11 a point's forces are those of its stress, added to what is there") {
  VERIFY_RANDOM(random, 111);
  constexpr int M = 2, K = 3;
  Worst added;
  for (int sample = 0; sample < 20; ++sample) {
    Vec3<double> D[K], R[K];
    Points before;
    for (int k = 0; k < K; ++k) {
      D[k] = vec3(random.vector(1));
      before.push_back(random.vector(1));
      R[k] = vec3(before.back());
    }
    PointLanes<double, M> point{};
    for (int k = 0; k < M; ++k) {
      point.t1[k] = random.uniform(-1, 1);
      point.t2[k] = random.uniform(-1, 1);
    }
    point.weight = random.uniform(0.5, 2);
    const FibreStress<double> stress{random.uniform(-1, 1), random.uniform(-1, 1),
                                     random.uniform(-1, 1)};
    add_point_forces(PointKinematics<double, M, K>(D, point), stress, point, R);
    // [E-3]: f_i = sum_k t_ik D_k, the generalised force on D_k is weight m^{ij} f_j t_ik.
    Eigen::Matrix<double, 3, M> vectors;
    Eigen::Matrix<double, M, 2> t;
    for (int k = 0; k < M; ++k) {
      vectors.col(k) = eigen(D[k]);
      t.row(k) << point.t1[k], point.t2[k];
    }
    Eigen::Matrix2d m;
    m << stress.m11, stress.m12, stress.m12, stress.m22;
    const Eigen::Matrix<double, 3, M> force = point.weight * vectors * t * m * t.transpose();
    for (int k = 0; k < K; ++k) {
      const Vector3d expected = before[k] + (k < M ? Vector3d(force.col(k)) : Vector3d::Zero());
      added.see((eigen(R[k]) - expected).norm(), sample, k);
    }
  }
  added.claim("V-ELEM-11", 1e-14, "forces of size 1 against the product of the matrices");
}

TEST_CASE("V-ELEM-07 fibres at 45 degrees lock an element of 2x2 points and not one of one point") {
  // Warp and weft as the two families of a translation surface in the plane, x = a(s) + b(t) with
  // a and b curves in their own arc length: no yarn is strained anywhere, the shear angle varies.
  const auto curve = [](double s, double start, double curvature) {
    return Vector3d((std::sin(start + curvature * s) - std::sin(start)) / curvature,
                    (std::cos(start) - std::cos(start + curvature * s)) / curvature, 0);
  };
  constexpr double curvature = 1 / 80.0;  // of both families [1/mm], in opposite senses
  const auto trellis = [&](const Vector3d& X, double warp) -> Vector3d {
    const double s = X.dot(direction(warp)), t = X.dot(direction(warp + pi / 2));
    return curve(s, warp, curvature) + curve(t, warp + pi / 2, -curvature);
  };
  struct Result {
    double yarn, shear;
  };
  const auto stored = [&](auto kind, const auto& law, int n, double warp) {
    using Kind = decltype(kind);
    const auto m = rectangle(40, 40, n, n, warp);
    auto sweep = sweep_of<Kind>(m, law);
    Points x;
    for (int k = 0; k < m.node_count; ++k) x.push_back(trellis(eigen(m.nodes.get(k)), warp));
    EnergyLedger e;
    sweep.add_energy(state_at(m, x), e);
    return Result{e.value("yarn"), e.value("shear")};
  };
  const auto law = fabric(pi / 2, 1e-3);  // Table 1 with the paper's shear modulus
  const Result one = stored(OnePointKind{}, law, 8, pi / 4);
  const Result four = stored(FourPointKind{}, law, 8, pi / 4);
  const Result aligned = stored(FourPointKind{}, law, 8, 0);
  REQUIRE(one.shear > 1e-3);  // the field does shear the fabric
  // The energy of the yarns should be zero. What 2x2 points add is locking: more than all the
  // shear.
  claim("V-ELEM-07", four.yarn / four.shear, 1, "2x2 points, 45 deg, 5 mm: yarn over shear energy",
        verify::Bound::lower);
  claim("V-ELEM-07", one.yarn / four.yarn, 0.1, "one point's yarn energy over that of 2x2 points");
  claim("V-ELEM-07", aligned.yarn / four.yarn, 0.1,
        "aligned mesh's yarn energy over that at 45 deg");

  // Why: the strain at the 2x2 points is wrong by O(h), at the centre by O(h^2). Seen through a
  // quadratic energy these are the rates 2 and 4.
  const LinearLaw<double> linear;
  const auto rate = [&](auto kind) {
    return std::log2(stored(kind, linear, 16, pi / 4).yarn / stored(kind, linear, 32, pi / 4).yarn);
  };
  // Within the next term of the series, (curvature h)^2 = 1e-3 at these meshes.
  claim("V-ELEM-07", std::abs(rate(FourPointKind{}) - 2), 0.05, "rate of 2x2 points, off 2");
  claim("V-ELEM-07", std::abs(rate(OnePointKind{}) - 4), 0.05, "rate of one point, off 4");

  const auto over_h = [&](const char* name, auto kind, double warp) {
    verify::Curve energies{name, {}, {}};
    for (int n = 4; n <= 64; n *= 2) {
      energies.x.push_back(40.0 / n);
      energies.y.push_back(stored(kind, law, n, warp).yarn / one.shear);
    }
    return energies;
  };
  verify::Plot plot{"V-ELEM-07",
                    "Tension locking",
                    "element size [mm]",
                    "yarn energy over shear energy",
                    true,
                    true,
                    {over_h("2x2 points, 45 deg", FourPointKind{}, pi / 4),
                     over_h("one point, 45 deg", OnePointKind{}, pi / 4),
                     over_h("2x2 points, aligned", FourPointKind{}, 0)},
                    "A shear that strains no yarn: the yarn energy should be nothing. 2x2 points "
                    "at 45 deg store more of it than all the shear; one point does not."};
  plot.curves.push_back(verify::guide("order 2", 2, plot.curves[0]));
  plot.curves.push_back(verify::guide("order 4", 4, plot.curves[1], 3));
  verify::show(plot);
}

namespace {

/// A force that does not change, given per node; its potential is booked as yarn energy.
class NodeForces final : public ForceBlock<double> {
 public:
  explicit NodeForces(Points f) : f_(std::move(f)) {}
  void add_forces(NodalState<double>& state, double) override {
    for (int n = 0; n < state.node_count; ++n)
      state.f.set(n, state.f.get(n) + vec3(f_[static_cast<std::size_t>(n)]));
  }
  void add_energy(const NodalState<double>& state, EnergyLedger& e) const override {
    double potential = 0;
    for (int n = 0; n < state.node_count; ++n)
      potential -= f_[static_cast<std::size_t>(n)].dot(eigen(state.x.get(n)));
    e.add("load", EnergyKind::stored, potential);
  }
  [[nodiscard]] double omega_squared() const override { return 0; }

 private:
  Points f_;
};

/// A taut sheet pulled out of its plane: the deformation that is to be found.
struct Manufactured {
  static constexpr double side = 40;
  template <class T>
  static std::array<T, 3> map(const T& X, const T& Y) {
    using std::sin;
    const T sx = sin(T(pi / side) * X), sy = sin(T(pi / side) * Y);
    const T s2x = sin(T(2 * pi / side) * X);
    return {T(1.02) * X + T(0.05) * s2x * sy, T(1.02) * Y - T(0.04) * sx * sy + T(0.01) * X,
            T(1.0) * sx * sy};
  }

  /// -Div P, the load per reference area, by dual numbers twice over: once for F, once for Div.
  template <class Law>
  static Vector3d load(const Law& law, double X, double Y) {
    using D = Dual<double, 2>;
    using DD = Dual<D, 2>;
    const auto x = map(DD::variable(D::variable(X, 0), 0), DD::variable(D::variable(Y, 1), 1));
    const double c1 = std::cos(warp_angle), s1 = std::sin(warp_angle);
    const double c2 = std::cos(warp_angle + fibre_angle), s2 = std::sin(warp_angle + fibre_angle);
    std::array<D, 3> f1, f2;
    for (int i = 0; i < 3; ++i) {
      f1[i] = x[i].d[0] * D(c1) + x[i].d[1] * D(s1);
      f2[i] = x[i].d[0] * D(c2) + x[i].d[1] * D(s2);
    }
    const auto dot3 = [](const auto& a, const auto& b) {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    };
    const FibreStrain<D> beta{D(0.5) * (dot3(f1, f1) - D(1)), D(0.5) * (dot3(f2, f2) - D(1)),
                              D(0.5) * (dot3(f1, f2) - D(std::cos(fibre_angle)))};
    const auto m = law.stress(law.evaluate(beta));
    Vector3d out;
    for (int i = 0; i < 3; ++i) {
      const D along1 = m.m11 * f1[i] + m.m12 * f2[i], along2 = m.m12 * f1[i] + m.m22 * f2[i];
      const D Px = along1 * D(c1) + along2 * D(c2), Py = along1 * D(s1) + along2 * D(s2);
      out[i] = -(Px.d[0] + Py.d[1]);
    }
    return out;
  }
};

/// Root mean square distance of the relaxed sheet of n x n squares from the manufactured solution,
/// over the side. `load(X, Y)` per reference area [kN/mm^2].
template <class Kind, class Law, class Load>
double manufactured_error(const Law& law, int n, const Load& load_at) {
  using T = NativePack<double>;
  constexpr int corners = corners_of<Kind>;
  const double h = Manufactured::side / n;
  verify::Random unused(1);
  const Points X = grid(n, n, h, 0, unused);
  const auto m = mesh<corners>(X, cells<corners>(n, n), warp_angle, fibre_angle);
  std::vector<NodeConstraint> fixed;
  Points exact, load;
  double strongest = 0;
  const auto area = m.tributary_areas();
  for (int k = 0; k < m.node_count; ++k) {
    const auto x = Manufactured::map(X[k].x(), X[k].y());
    exact.push_back({x[0], x[1], x[2]});
    const bool rim = k / (n + 1) == 0 || k / (n + 1) == n || k % (n + 1) == 0 || k % (n + 1) == n;
    if (rim) fixed.push_back({k, true, true, true});
    load.push_back(h * h * load_at(X[k].x(), X[k].y()));
    if (!rim) strongest = std::max(strongest, load.back().norm() / (h * h));
  }
  REQUIRE(strongest > 1e-3);  // kN/mm^2: the forcing is really there
  NodalState<double> state(m, areal_mass, fixed);
  for (int k = 0; k < m.node_count; ++k) state.x.set(k, vec3(exact[k]));
  // Slowest motion: out of the plane under a tension of 0.3 kN/mm; critically damped.
  const double slowest = pi * std::sqrt(2 * 0.3 / areal_mass) / Manufactured::side;
  Model<real_t<T>> model(std::move(state), 2 * slowest);
  model.add(std::make_unique<MembraneSweep<T, typename Kind::Element, Law>>(
      m, law, areal_mass, MembraneOptions{0.05, 0}));
  model.add(std::make_unique<NodeForces>(load));
  const double dt = 0.9 * model.critical_step();
  CentralDifference<T> run(std::move(model), TimeStep::fixed(dt));
  const int steps = static_cast<int>(20 / (slowest * dt));  // e^-20 of the start's error
  for (int k = 0; k < steps; ++k) run.step();
  double sum = 0;
  for (int k = 0; k < m.node_count; ++k)
    sum += area[k] * (eigen(run.state().x.get(k)) - exact[k]).squaredNorm();
  return std::sqrt(sum) / Manufactured::side;
}

/// The orders of three meshes, for all three elements.
template <class Law, class Load>
void claim_order(const char* id, const char* title, const Law& law, const Load& load) {
  Worst orders;
  verify::Plot plot{id,
                    title,
                    "edge of an element [mm]",
                    "distance from the solution [mm]",
                    true,
                    true,
                    {},
                    "The error of every element falls along slope 2."};
  for_each_kind([&](auto kind) {
    using Kind = decltype(kind);
    verify::Curve curve{Kind::name, {}, {}};
    for (const int n : {8, 16, 32}) {
      curve.x.push_back(Manufactured::side / n);
      curve.y.push_back(manufactured_error<Kind>(law, n, load));
    }
    const auto& e = curve.y;
    INFO(Kind::name, ": ", e[0], " ", e[1], " ", e[2]);
    REQUIRE(e[0] < 0.1);  // mm, of a deflection of 1 mm
    orders.see(std::abs(std::log2(e[0] / e[1]) - 2), Kind::name, "8 to 16", e[0], e[1]);
    orders.see(std::abs(std::log2(e[1] / e[2]) - 2), Kind::name, "16 to 32", e[1], e[2]);
    plot.curves.push_back(curve);
  });
  const auto& first = plot.curves[0];
  plot.curves.push_back({"slope 2",
                         {first.x[0], first.x[2]},
                         {first.y[0] / 2, first.y[0] / 32},
                         verify::Curve::Style::guide});
  verify::show(plot);
  // The next term is of relative size (pi h / side)^2 = 0.15 at the coarsest mesh.
  orders.claim(id, 0.15, "distance of the order from 2");
}

}  // namespace

TEST_CASE("V-ELEM-08 a manufactured solution is approached with order 2") {
  // A shear modulus of the yarns' size lets the relaxation converge soon; the order does not
  // depend on it.
  const auto law = fabric(fibre_angle, 2.0);
  claim_order("V-ELEM-08", "Manufactured solution, woven law", law,
              [&](double X, double Y) { return Manufactured::load(law, X, Y); });
}

TEST_CASE("V-ELEM-09 the load that a symbolic program derives is that of the dual numbers") {
  VERIFY_RANDOM(random, 109);
  LinearLaw<double> law;
  law.angle = FibreAngle<double>(fibre_angle);
  const auto derived = [&](double X, double Y) {
    const auto warp = direction(warp_angle), weft = direction(warp_angle + fibre_angle);
    const auto b = manufactured::load(X, Y, Manufactured::side, law.C, law.G, warp.x(), warp.y(),
                                      weft.x(), weft.y());
    return Vector3d(b[0], b[1], b[2]);
  };
  Worst positions, loads;
  Vector3d strongest = Vector3d::Zero();
  std::vector<std::pair<Vector3d, Vector3d>> pairs;
  for (int sample = 0; sample < 1000; ++sample) {
    const double X = random.uniform(0, Manufactured::side);
    const double Y = random.uniform(0, Manufactured::side);
    const auto x = Manufactured::map(X, Y), y = manufactured::position(X, Y, Manufactured::side);
    for (int i = 0; i < 3; ++i) positions.see(std::abs(x[i] - y[i]), X, Y);
    pairs.emplace_back(Manufactured::load(law, X, Y), derived(X, Y));
    strongest = strongest.cwiseMax(pairs.back().second.cwiseAbs());
  }
  // Every component of the forcing is really there [kN/mm^2].
  REQUIRE(strongest.minCoeff() > 1e-3);
  for (const auto& [dual, symbolic] : pairs)
    loads.see((dual - symbolic).cwiseQuotient(strongest).cwiseAbs().maxCoeff());
  // A rounding of 40 mm; some fifty terms of the load's own size, each with its roundings.
  positions.claim("V-ELEM-09", 2e-14, "positions of the two programs [mm]");
  loads.claim("V-ELEM-09", 1e-13, "load by dual numbers against the symbolic one, relative");
  claim_order("V-ELEM-09", "Manufactured solution, quadratic law, symbolic load", law, derived);
}
