// Rotation-free bending: second differences against polynomials, rolled sheets against D/(2 R^2), a
// cantilever against F L^3/(3 D), mirrored models against whole ones.

#include "element/patches.hpp"
#include "support/claim.hpp"
#include "support/plots.hpp"
#include "support/taylor_test.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <utility>

namespace {

using namespace patches;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using verify::claim;
using verify::Worst;

using Bending = BendingSweep<Lane>;

/// Area of the nodes that carry a stencil: everything but the rim.
template <int Corners>
double inner_area(const Mesh<Corners>& m, int nx, int ny) {
  const auto A = m.tributary_areas();
  double sum = 0;
  for (int i = 1; i < nx; ++i)
    for (int j = 1; j < ny; ++j) sum += A[static_cast<std::size_t>(i * (ny + 1) + j)];
  return sum;
}

/// Rolled isometrically on a cylinder of radius R about the y axis.
Points rolled(const Points& X, double R) {
  Points x;
  for (const auto& p : X)
    x.push_back({R * std::sin(p.x() / R), p.y(), R * (1 - std::cos(p.x() / R))});
  return x;
}

/// Solution of a positive definite system whose right-hand side is the last column.
std::vector<double> eliminate(std::vector<std::vector<double>> K) {
  const std::size_t size = K.size();
  for (std::size_t p = 0; p < size; ++p)
    for (std::size_t r = p + 1; r < size; ++r) {
      const double factor = K[r][p] / K[p][p];
      if (factor == 0) continue;
      for (std::size_t c = p; c <= size; ++c) K[r][c] -= factor * K[p][c];
    }
  std::vector<double> z(size);
  for (std::size_t r = size; r-- > 0;) {
    double sum = K[r][size];
    for (std::size_t c = r + 1; c < size; ++c) sum -= K[r][c] * z[c];
    z[r] = sum / K[r][r];
  }
  return z;
}

}  // namespace

TEST_SUITE_BEGIN("element");
TEST_CASE("V-BEND-01 the second difference is exact for every quadratic field") {
  VERIFY_RANDOM(random, 201);
  Worst exact, sizes;
  for (double distortion : {0.0, 0.2})
    for (double angle : {0.0, pi / 4, pi / 2, 3 * pi / 4, 0.3, 1.1, 2.0})
      for (int sample = 0; sample < 20; ++sample) {
        const Points X = grid(2, 2, 5, distortion, random);
        std::vector<StencilNeighbour> ring;
        const Vector3d along = direction(angle), across = direction(angle + pi / 2);
        for (int n = 0; n < 9; ++n)
          if (n != 4) {
            const Vector3d d = X[n] - X[4];
            // Coordinates on the fibre line are there up to rounding; the mesh gives no more.
            ring.push_back({n, d.dot(along), d.dot(across)});
          }
        const bool on_line = distortion == 0 && std::abs(std::sin(4 * angle)) < 1e-9;
        const auto three = three_point_difference(4, ring);
        REQUIRE(three.size() == (on_line ? 3 : 0));
        const auto weights = on_line ? three : quadratic_difference(4, ring);
        REQUIRE(!weights.empty());

        const double c = random.uniform(-1, 1), cx = random.uniform(-1, 1),
                     cy = random.uniform(-1, 1);
        const double cxx = random.uniform(-1, 1), cxy = random.uniform(-1, 1),
                     cyy = random.uniform(-1, 1);
        double kappa = 0, size = 0, weight = 0, radius = 0;
        for (const auto& r : ring) radius = std::max(radius, std::hypot(r.along, r.across));
        for (const auto& w : weights) {
          const double x = X[w.id].x(), y = X[w.id].y();
          const double value = c + cx * x + cy * y + cxx * x * x + cxy * x * y + cyy * y * y;
          kappa += w.weight * value;
          size += std::abs(w.weight * value);
          if (w.id != 4) weight += std::abs(w.weight);
        }
        sizes.see(weight * radius * radius, distortion, angle, sample);
        const double dx = along.x(), dy = along.y();
        const double expected = 2 * (cxx * dx * dx + cxy * dx * dy + cyy * dy * dy);
        exact.see(std::abs(kappa - expected) / size, distortion, angle, sample);
      }
  // Nine terms of the sum are rounded to 1e-16 each, and the coordinates of the ring before them.
  exact.claim("V-BEND-01", 1e-14, "second derivative, relative to the sum of the terms");
  sizes.claim("V-BEND-01", stencil_limit / 2, "sum of |w| r^2 inside distorted meshes");

  // Along the line, unequal neighbours too.
  const auto uneven =
      three_point_difference(0, {{1, 2.0, 0.0}, {2, -0.7, 0.0}, {3, 0.1, 1.0}, {4, 3.0, 0.0}});
  REQUIRE(uneven.size() == 3);
  double linear = 0, quadratic = 0, constant = 0;
  for (const auto& w : uneven) {
    const double s = w.id == 0 ? 0.0 : w.id == 1 ? 2.0 : -0.7;
    constant += w.weight;
    linear += w.weight * s;
    quadratic += w.weight * s * s;
  }
  claim("V-BEND-01", std::abs(constant) + std::abs(linear) + std::abs(quadratic - 2), 1e-15,
        "unequal spacing: moments of the weights off 0, 0, 2");

  // The nearest node on each side is taken, in whatever order the ring has them; a node is on the
  // line within 1e-9 of the ring's radius, which neither its size nor its direction changes.
  for (const double unit : {1e-2, 1.0, 1e2}) {
    const auto ids = [&](double across, double far_along, double far_across) {
      std::set<int> out;
      for (const auto& w : three_point_difference(0, {{5, -2 * unit, 0},
                                                      {1, -0.5 * unit, across * unit},
                                                      {6, -3 * unit, 0},
                                                      {7, 2.5 * unit, 0},
                                                      {2, 0.4 * unit, 0},
                                                      {8, 1.5 * unit, 0},
                                                      {9, far_along * unit, far_across * unit}}))
        out.insert(w.id);
      return out;
    };
    const std::set<int> nearest{0, 1, 2}, next{0, 2, 5};
    for (const auto& [along, across] : {std::pair{8.0, 6.0}, {0.0, 10.0}, {10.0, 0.0}}) {
      CHECK(ids(0.9e-8, along, across) == nearest);
      CHECK(ids(-0.9e-8, along, across) == nearest);
      CHECK(ids(1.1e-8, along, across) == next);
    }
  }
  // A node at the centre is no neighbour, of two at one place the first counts, and exactly on the
  // limit of the rounding is on the line.
  const auto chosen = [](const std::vector<StencilNeighbour>& ring) {
    std::vector<int> out;
    for (const auto& w : three_point_difference(0, ring)) out.push_back(w.id);
    return out;
  };
  CHECK(chosen({{9, 0.0, 0.0}, {1, -1.0, 0.0}, {2, 1.0, 0.0}}) == std::vector{1, 0, 2});
  CHECK(chosen({{1, -1.0, 0.0}, {2, 1.0, 0.0}, {3, -1.0, 0.0}, {4, 1.0, 0.0}}) ==
        std::vector{1, 0, 2});
  CHECK(chosen({{1, -0.5, 1e-9}, {2, 1.0, 0.0}}) == std::vector{1, 0, 2});

  // [B-3]: of all exact weights those with the least sum of w^2/v, v = (n^2 + 1e-3)^-2 in units of
  // the ring's radius; refused where the sum of their sizes exceeds the limit. By the normal
  // equations of the weights themselves, in long double.
  Worst least;
  int given = 0, refused = 0, disagree = 0;
  using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  for (int sample = 0; sample < 4000; ++sample) {
    const int count = 5 + sample % 4;
    const double unit = std::array{0.02, 1.0, 30.0}[sample % 3];
    std::vector<StencilNeighbour> ring;
    double radius = 0;
    for (int k = 0; k < count; ++k) {
      // All around, or anywhere.
      const double angle = sample % 2 == 0 ? 2 * pi * (k + random.uniform(-0.4, 0.4)) / count
                                           : random.uniform(0, 2 * pi);
      const double r = unit * random.uniform(0.5, 1.5);
      ring.push_back({k + 1, r * std::cos(angle), r * std::sin(angle)});
      radius = std::max(radius, r);
    }
    Long K = Long::Zero(count + 5, count + 5), b = Long::Zero(count + 5, 1);
    for (int k = 0; k < count; ++k) {
      const long double s = ring[k].along / radius, n = ring[k].across / radius;
      K(k, k) = (n * n + 1e-3L) * (n * n + 1e-3L);
      const long double moments[] = {s, n, s * s, s * n, n * n};
      for (int m = 0; m < 5; ++m) K(k, count + m) = K(count + m, k) = moments[m];
    }
    b(count + 2) = 2;
    const Long w = K.fullPivLu().solve(b);
    const long double sum = w.col(0).head(count).cwiseAbs().sum();
    const auto weights = quadratic_difference(0, ring);
    if (std::abs(sum / stencil_limit - 1) > 1e-6L)
      disagree += weights.empty() != (sum > stencil_limit);
    (weights.empty() ? refused : given)++;
    for (const auto& weight : weights)
      if (weight.id > 0)
        least.see(
            static_cast<double>(std::abs(weight.weight * radius * radius - w(weight.id - 1)) / sum),
            sample);
  }
  REQUIRE(given > 1000);
  REQUIRE(refused > 50);
  CHECK(disagree == 0);
  // The condition of the matrix, 1e6 by the weights v, once more after two passes.
  least.claim("V-BEND-01", 1e-8, "weights of random rings against the least ones, over their sum");

  // A ring on one side only, as at a free edge, would extrapolate: it is refused.
  for (double angle : {pi / 4, 0.3, 1.1})
    for (double distortion : {1e-3, 1e-2}) {
      std::vector<StencilNeighbour> ring;
      const Vector3d along = direction(angle), across = direction(angle + pi / 2);
      for (int n : {0, 2, 3, 4, 5}) {
        Vector3d d(n / 3, n % 3 - 1, 0);
        d += distortion * random.vector(1);
        ring.push_back({n, d.dot(along), d.dot(across)});
      }
      CHECK(quadratic_difference(1, ring).empty());
    }

  // Rings whose radius cannot be squared, or that reach to infinity, are refused.
  using Limits = std::numeric_limits<double>;
  const double shortest = std::sqrt(Limits::min() / Limits::epsilon()),
               longest = std::sqrt(Limits::max() * Limits::epsilon());
  const auto weights = [](double radius, double far) {
    std::vector<StencilNeighbour> ring;
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j)
        if (i != 0 || j != 0) ring.push_back({3 * i + j, radius * i, radius * j});
    ring[0].along *= far;
    return three_point_difference(99, ring).size() + quadratic_difference(99, ring).size();
  };
  const double corner = std::sqrt(2.0);
  CHECK(weights(1, 1) == 12);
  CHECK(weights(1.001 * shortest / corner, 1) == 12);
  CHECK(weights(0.999 * shortest / corner, 1) == 0);
  CHECK(weights(0.999 * longest / corner, 1) == 12);
  CHECK(weights(1.001 * longest / corner, 1) == 0);
  CHECK(weights(1, std::numeric_limits<double>::infinity()) == 0);
  CHECK(weights(1, std::numeric_limits<double>::quiet_NaN()) == 0);
  // Nearest neighbours so close that a weight overflows.
  for (double close : {1.0, -1.0})
    CHECK(three_point_difference(99, {{0, close * 1e-200, 0}, {1, -close * 1e-120, 0}}).empty());
  CHECK(three_point_difference(99, {{0, 1e-160, 0}, {1, -1, 0}, {2, 1, 0}}).size() == 3);
}

TEST_CASE("V-BEND-02 cylinder patch: D/(2 R^2) per area, approached with order 2") {
  VERIFY_RANDOM(random, 202);
  constexpr double R = 40, side = 40, warp = 1.3e-3, weft = 0.7e-3;
  const auto density = [&](int n, double angle, double distortion, auto corners) {
    verify::Random same(7);
    const double h = side / n;
    const Points X = inner_distortion(n, n, h, distortion, same);
    const auto m = mesh<corners.value>(X, cells<corners.value>(n, n), angle, pi / 2);
    Bending block(m, {warp, weft}, areal_mass);
    double area = inner_area(m, n, n);
    if (angle == 0) {  // the yarns along the rim are there as well; those rolled are half of them
      REQUIRE(block.stencils() == 2 * (n - 1) * (n + 1));
      area += h * h * (n - 1);
    } else {
      REQUIRE(block.stencils() == 2 * (n - 1) * (n - 1));
    }
    return energy(block, state_at(m, rolled(X, R))) / area;
  };
  const std::integral_constant<int, 4> quads;
  const std::integral_constant<int, 3> triangles;
  Worst errors, orders;
  const auto check = [&](double angle, double distortion, auto corners, double order_tolerance,
                         const char* name) {
    // Curvature of the two families: cos^2/R and sin^2/R.
    const double c = std::cos(angle) * std::cos(angle), s = 1 - c;
    const double expected = (warp * c * c + weft * s * s) / (2 * R * R);
    const double e1 = std::abs(density(16, angle, distortion, corners) / expected - 1);
    const double e2 = std::abs(density(32, angle, distortion, corners) / expected - 1);
    errors.see(e2, name, angle, distortion);
    INFO(name, ", ", angle, ", ", distortion, ": ", e1, " ", e2);
    CHECK(e2 < e1);
    if (order_tolerance > 0)
      orders.see(std::abs(std::log2(e1 / e2) - 2), name, angle, distortion, e1, e2);
  };
  for (double angle : {0.0, pi / 4, 0.4, 2.2}) check(angle, 0, quads, 0.1, "quadrilaterals");
  check(pi / 4, 0, triangles, 0.1, "triangles");
  check(0.4, 0, triangles, 0.1, "triangles");
  // Distorted: the terms of third order left out are tangential on a cylinder, and the energy
  // does not feel them; the order is that of the mean over a random mesh and is not asked for
  // closely.
  for (double angle : {0.0, pi / 4, 0.4}) check(angle, 0.2, quads, 0, "quadrilaterals");
  check(0.4, 0.2, triangles, 0, "triangles");
  // (h/R)^2 times a constant of order 1, with h = 1.25 mm: 1e-3.
  errors.claim("V-BEND-02", 2e-3, "energy per area at R/h = 32, relative");

  verify::Plot plot{"V-BEND-02",
                    "A rolled sheet",
                    "h/R",
                    "error of the energy, relative",
                    true,
                    true,
                    {},
                    "The bending energy D cos^4/(2 R^2) of each family is approached with order 2, "
                    "whatever the angle between yarns and mesh."};
  const auto over_h = [&](const char* name, double angle, auto corners) {
    const double c = std::cos(angle) * std::cos(angle), s = 1 - c;
    const double expected = (warp * c * c + weft * s * s) / (2 * R * R);
    verify::Curve curve{name, {}, {}};
    for (int n = 8; n <= 64; n *= 2) {
      curve.x.push_back(side / n / R);
      curve.y.push_back(std::abs(density(n, angle, 0, corners) / expected - 1));
    }
    plot.curves.push_back(curve);
  };
  over_h("quads, 0 deg", 0, quads);
  over_h("quads, 45 deg", pi / 4, quads);
  over_h("quads, 0.4 rad", 0.4, quads);
  over_h("triangles, 0.4 rad", 0.4, triangles);
  plot.curves.push_back(verify::guide("order 2", 2, plot.curves[0], 0.5));
  verify::show(plot);
  orders.claim("V-BEND-02", 0.1, "distance of the order from 2, regular meshes");
}

TEST_CASE("V-BEND-03 mirror planes: the part of a symmetric sheet bends as the whole does") {
  VERIFY_RANDOM(random, 203);
  constexpr int n = 4;  // elements per quarter side
  constexpr double h = 3;
  Worst energies, forces;
  for (double angle : {0.0, pi / 4})
    for (bool distorted : {false, true}) {
      // Quarter: x, y >= 0. Its nodes on a plane stay there.
      Points X = distorted ? inner_distortion(n, n, h, 0.2, random) : grid(n, n, h, 0, random);
      Points x = X;
      for (auto& p : x) {
        const Vector3d d = random.vector(0.5);
        p += Vector3d(p.x() == 0 ? 0 : d.x(), p.y() == 0 ? 0 : d.y(), d.z());
      }
      const auto quarter = mesh<4>(X, cells<4>(n, n), angle, pi / 2);

      // Whole: every node of the 2n x 2n grid is an image of a quarter's.
      const auto image = [&](int i, int j) { return std::abs(i - n) * (n + 1) + std::abs(j - n); };
      const auto mirrored = [&](const Points& P, int i, int j) {
        const Vector3d p = P[static_cast<std::size_t>(image(i, j))];
        return Vector3d(i < n ? -p.x() : p.x(), j < n ? -p.y() : p.y(), p.z());
      };
      Points X_whole, x_whole;
      for (int i = 0; i <= 2 * n; ++i)
        for (int j = 0; j <= 2 * n; ++j) {
          X_whole.push_back(mirrored(X, i, j));
          x_whole.push_back(mirrored(x, i, j));
        }
      const auto whole = mesh<4>(X_whole, cells<4>(2 * n, 2 * n), angle, pi / 2);

      // At 45 deg mirroring exchanges the families: they need the same stiffness.
      const BendingStiffness D{1e-3, angle == 0 ? 2e-3 : 1e-3};
      Bending part(quarter, D, areal_mass, {true, true}), all(whole, D, areal_mass);
      auto state = state_at(quarter, x), state_whole = state_at(whole, x_whole);
      const double W = energy(part, state);
      REQUIRE(W > 1e-6);
      energies.see(std::abs(energy(all, state_whole) / (4 * W) - 1), angle, distorted);

      const Points f = gradient(part, state), g = gradient(all, state_whole);
      for (int i = n; i <= 2 * n; ++i)
        for (int j = n; j <= 2 * n; ++j) {
          // A node on a plane is there once in the whole, and half of it belongs to the part.
          const Vector3d a = f[static_cast<std::size_t>(image(i, j))];
          const double share = (i == n ? 2 : 1) * (j == n ? 2 : 1);
          const Vector3d expected(i == n ? 0 : share * a.x(), j == n ? 0 : share * a.y(),
                                  share * a.z());
          const Vector3d b = g[static_cast<std::size_t>(i * (2 * n + 1) + j)];
          forces.see((b - expected).norm() / largest(g), angle, distorted, i, j);
        }
    }
  // The same sums in another order; a hundred roundings.
  energies.claim("V-BEND-03", 1e-13, "energy of the whole over four times the quarter's, off 1");
  forces.claim("V-BEND-03", 1e-13, "forces, relative to the largest");
}

TEST_CASE("V-BEND-04 free ends carry no moment: a cantilever bends as its closed form says") {
  constexpr double length = 40, width = 3, D = 1.4e-3, load = 1e-6;
  // The energy is quadratic: unit displacements give its matrix, and one solve the deflection.
  const auto deflection = [&](int n) {
    const auto m = rectangle(length, width, n, 1);
    Bending block(m, {D, 0}, areal_mass);
    Points X;
    for (int k = 0; k < m.node_count; ++k) X.push_back(eigen(m.nodes.get(k)));
    // Clamped: the first two rows of nodes stay, so that the end's slope is zero at h/2.
    const int size = m.node_count - 4;
    std::vector<std::vector<double>> K(size, std::vector<double>(size + 1, 0.0));
    for (int c = 0; c < size; ++c) {
      Points x = X;
      x[static_cast<std::size_t>(c + 4)].z() += 1;
      auto state = state_at(m, x);
      const Points g = gradient(block, state);
      for (int r = 0; r < size; ++r) K[r][c] = g[static_cast<std::size_t>(r + 4)].z();
    }
    K[size - 1][size] = K[size - 2][size] = load / 2;
    const std::vector<double> z = eliminate(K);
    // Nothing bends at the free end: its last stencil, one row in, has the moment of that place.
    const double h = length / n;
    const double kappa = (z[size - 1] - 2 * z[size - 3] + z[size - 5]) / (h * h);
    const double moment = D * width * kappa;
    CHECK(std::abs(moment / (load * h) - 1) < 1e-6);
    return z[size - 1];
  };
  const double exact = load * length * length * length / (3 * D * width);
  // With the slope fixed at h/2 the strip is that much shorter, which the finest mesh still
  // shows; two meshes tell the order and extrapolate.
  const double z40 = deflection(40), z80 = deflection(80), z160 = deflection(160);
  INFO(exact, " ", z40, " ", z80, " ", z160);
  REQUIRE(std::abs(z40 / exact - 1) < 0.1);
  const double order = std::log2((z80 - z40) / (z160 - z80));
  claim("V-BEND-04", std::abs(order - 1), 0.1,
        "order of the deflection with a two-row clamp, off 1");
  // What is left after removing the first order is of the second, (h/L)^2 = 4e-5 times 3.
  claim("V-BEND-04", std::abs((2 * z160 - z80) / exact - 1), 2e-4,
        "deflection against F L^3/(3 D b), extrapolated, relative");
}

TEST_CASE("V-BEND-05 rigid motions and affine maps cost no bending; forces turn along") {
  VERIFY_RANDOM(random, 205);
  Worst costs, turned, sums;
  for (double angle : {0.0, pi / 4, 0.4}) {
    const Points X = grid(5, 4, 3, 0.2, random);
    const auto m = mesh<4>(X, cells<4>(5, 4), angle, 1.3);
    Bending block(m, {1e-3, 2e-3}, areal_mass);
    REQUIRE(block.stencils() > 12);
    const Matrix3d Q = random.rotation();
    REQUIRE(is_rotation(Q));
    Points x = X;
    for (auto& p : x) p += random.vector(0.5);
    auto bent = state_at(m, x), bent_turned = state_at(m, map(x, Q, random.vector(20)));
    const double W = energy(block, bent);
    REQUIRE(W > 1e-6);
    auto rigid = state_at(m, map(X, Q, random.vector(20)));
    auto affine = state_at(m, map(X, Q + random_matrix(random, 0.2)));
    const Points f = gradient(block, bent), g = gradient(block, bent_turned);
    costs.see(std::sqrt(energy(block, rigid) / W), angle, "rigid");
    costs.see(std::sqrt(energy(block, affine) / W), angle, "affine");
    costs.see(largest(gradient(block, rigid)) / largest(f), angle, "rigid, forces");
    Vector3d sum = Vector3d::Zero(), moment = Vector3d::Zero();
    for (std::size_t n = 0; n < f.size(); ++n) {
      turned.see((g[n] - Q * f[n]).norm() / largest(f), angle, n);
      sum += f[n];
      moment += x[n].cross(f[n]);
    }
    sums.see(sum.norm() / largest(f), angle);
    sums.see(moment.norm() / (15 * largest(f)), angle, "moment");
  }
  // Coordinates of 20 mm round to 4e-15 mm, and nine of them make a curvature; deflections are
  // 0.5 mm.
  costs.claim("V-BEND-05", 2e-13, "root of the energy, and forces, over those of a bent sheet");
  turned.claim("V-BEND-05", 2e-13, "forces after a rotation, relative");
  sums.claim("V-BEND-05", 2e-13, "sum and moment of the forces, relative");
}

TEST_CASE("V-BEND-06 bending forces are minus the gradient of the energy") {
  VERIFY_RANDOM(random, 206);
  Worst slopes;
  double mutated = 1e9;
  for (double angle : {0.0, pi / 4, 0.4}) {
    const Points X = grid(5, 4, 3, angle == 0 ? 0 : 0.2, random);
    const auto m = mesh<4>(X, cells<4>(5, 4), angle, pi / 2);
    Bending block(m, {1e-3, 2e-3}, areal_mass, {true, true});
    Points x = X, h = X;
    for (std::size_t n = 0; n < x.size(); ++n) {
      x[n] += random.vector(0.5);
      h[n] = random.vector(1);
    }
    auto state = state_at(m, x);
    const double W = energy(block, state);
    const Points g = gradient(block, state);
    double slope = 0;
    for (std::size_t n = 0; n < g.size(); ++n) slope += g[n].dot(h[n]);
    REQUIRE(std::abs(slope) > 0.01 * W);
    const auto remainder = [&](double factor) {
      return [&, factor](double eps) {
        Points y = x;
        for (std::size_t n = 0; n < y.size(); ++n) y[n] += eps * h[n];
        return energy(block, state_at(m, y)) - W - eps * factor * slope;
      };
    };
    const auto result = verify::taylor_test(2, remainder(1), 1e-2, 1e-14 * W);
    INFO(angle, result.table);
    slopes.see(result.deviation, angle);
    mutated = std::min(mutated, verify::taylor_test(2, remainder(1.1), 1e-2, 1e-14 * W).deviation);
  }
  // A quadratic: slope 2 to the rounding of the smallest remainder, 1e-15/1e-9.
  slopes.claim("V-BEND-06", 1e-3, "deviation from Taylor slope 2");
  claim("V-BEND-06", mutated, 0.1, "the same with a gradient that is 10 % wrong",
        verify::Bound::lower);
}

TEST_CASE("V-BEND-07 of a ring of more nodes than a stencil holds, the nearest are taken") {
  VERIFY_RANDOM(random, 207);
  constexpr int held = 31;  // and the node in their middle
  Worst energies;
  int wrong = 0;
  for (const int count : {held - 1, held, held + 1, 50}) {
    CAPTURE(count);
    // A fan of triangles around node 0, of distances in no order. No node lies on the yarn.
    Points X{{0, 0, 0}};
    std::vector<std::array<int, 3>> triangles;
    for (int k = 0; k < count; ++k) {
      X.push_back(random.uniform(1, 2) * direction(2 * pi * k / count));
      triangles.push_back({0, 1 + k, 1 + (k + 1) % count});
    }
    constexpr double angle = 0.0123, D = 2e-3;
    const auto m = mesh<3>(X, triangles, angle, pi / 2);
    Bending block(m, {D, 0}, areal_mass);
    REQUIRE(block.stencils() == 1);

    std::vector<StencilNeighbour> nearest;
    for (int k = 1; k <= count; ++k)
      nearest.push_back({k, X[k].dot(direction(angle)), X[k].dot(direction(angle + pi / 2))});
    std::sort(nearest.begin(), nearest.end(),
              [&](const auto& a, const auto& b) { return X[a.id].norm() < X[b.id].norm(); });
    nearest.resize(std::min(count, held));
    Points x = X;
    for (auto& p : x) p += random.vector(0.5);
    Vector3d kappa = Vector3d::Zero();
    std::set<int> in_stencil;
    for (const auto& w : quadratic_difference(0, nearest)) {
      kappa += w.weight * x[w.id];
      in_stencil.insert(w.id);
    }
    REQUIRE(in_stencil.size() == nearest.size() + 1);
    auto state = state_at(m, x);
    const double expected = D * m.tributary_areas()[0] * kappa.squaredNorm() / 2;
    energies.see(std::abs(energy(block, state) / expected - 1), count);
    const Points f = gradient(block, state);
    for (int n = 0; n <= count; ++n) wrong += (f[n].norm() > 0) != in_stencil.contains(n);
  }
  claim("V-BEND-07", wrong, 0, "nodes with a force that are not the nearest, or the reverse");
  // The rings are the same up to the rounding of the fibre's direction, and so are their weights up
  // to the condition of the Gram matrix.
  energies.claim("V-BEND-07", 1e-9, "energy against that of the nearest ring, relative");
}

TEST_SUITE_END();
