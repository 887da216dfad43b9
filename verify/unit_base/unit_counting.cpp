// A counting number: hand-counted expressions, the values of the plain number, and a count of the
// kernels that does not depend on the values where the number of sweeps is fixed.

#include "crossbeam/base/counting.hpp"

#include "crossbeam/base/dual.hpp"
#include "crossbeam/element/membrane.hpp"
#include "crossbeam/element/quadrilateral.hpp"
#include "crossbeam/tools/height_table.hpp"
#include "crossbeam/tools/stadium_ring.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <thread>
#include <type_traits>
#include <vector>

namespace {

using crossbeam::Counting;
using crossbeam::FibreAngle;
using crossbeam::OperationCount;
using crossbeam::SolverControl;
using crossbeam::Vec3;

/// What `work()` takes.
template <class Work>
OperationCount count(const Work& work) {
  crossbeam::reset_operation_count();
  work();
  return crossbeam::operation_count();
}

template <class R>
auto membrane(SolverControl control) {
  const auto angle = FibreAngle<R>::right();
  return crossbeam::WovenMembrane(
      crossbeam::CrossedBeamCell<R>(crossbeam::CellParameters<double>{}.cast<R>()),
      crossbeam::PolynomialShear<R>(
          crossbeam::PolynomialCurve<R>({R(5e-5), R(-8e-4), R(6e-3), R(-1.2e-2), R(8.5e-3)})),
      angle, crossbeam::YarnWidth::corrected, control);
}

/// Corners of a stretched and sheared unit square [mm] -> its corner forces [kN].
template <class T, class Law>
std::vector<T> corner_forces(const Law& law, double warp, double weft, double shear) {
  using Quad = crossbeam::Quadrilateral<1>;
  using R = crossbeam::real_t<T>;
  const auto constants = Quad::coefficients<R>(
      {{{R(0), R(0), R(0)}, {R(1), R(0), R(0)}, {R(1), R(1), R(0)}, {R(0), R(1), R(0)}}},
      {{R(1), R(0), R(0)}, {R(0), R(1), R(0)}})[0];
  crossbeam::PointLanes<T, Quad::membrane_vectors> point;
  for (int k = 0; k < Quad::membrane_vectors; ++k) {
    point.t1[k] = T(constants.t1[static_cast<std::size_t>(k)]);
    point.t2[k] = T(constants.t2[static_cast<std::size_t>(k)]);
  }
  point.weight = T(constants.weight);
  const double a = 1 + warp, b = 1 + weft, s = std::sin(shear), c = std::cos(shear);
  const Vec3<T> x[4] = {{T(0), T(0), T(0)},
                        {T(a), T(0), T(0)},
                        {T(a + b * s), T(b * c), T(0)},
                        {T(b * s), T(b * c), T(0)}};
  Vec3<T> D[3], R_[3]{}, f[4];
  Quad::relative_vectors(x, D);
  const crossbeam::PointKinematics<T, Quad::membrane_vectors, 3> kinematics(D, point);
  const auto at = law.evaluate(kinematics.strain(law.reference().cosine));
  crossbeam::add_point_forces(kinematics, law.stress(at), point, R_);
  Quad::corner_forces(R_, f);
  std::vector<T> out;
  for (const auto& v : f) out.insert(out.end(), {v.x, v.y, v.z});
  return out;
}

/// Gap and normal at a point [mm].
template <class T, class Surface>
std::vector<T> gap_of(const Surface& surface, double x, double y, double z) {
  const auto gap = surface.gap(Vec3<T>{T(x), T(y), T(z)});
  return {gap.gap, gap.normal.x, gap.normal.y, gap.normal.z, gap.clearance};
}

template <class R>
void check_equal(const std::vector<Counting<R>>& counted, const std::vector<R>& plain) {
  REQUIRE(counted.size() == plain.size());
  for (std::size_t k = 0; k < plain.size(); ++k) CHECK(counted[k].v == plain[k]);
}

}  // namespace

TEST_SUITE_BEGIN("base");

TEST_CASE_TEMPLATE("a counting number counts what is written", R, float, double) {
  using C = Counting<R>;
  const C a(2), b(3), c(5);
  C r;
  CHECK(count([&] { r = a * b + c; }) == OperationCount{.additions = 1, .multiplications = 1});
  CHECK(r.v == R(11));
  CHECK(count([&] { r = (a - b) / sqrt(c); }) ==
        OperationCount{.additions = 1, .divisions = 1, .square_roots = 1});
  CHECK(count([&] { r = crossbeam::maximum(a, b) - crossbeam::minimum(b, c); }) ==
        OperationCount{.additions = 1, .comparisons = 2, .selections = 2});
  CHECK(count([&] { r = crossbeam::magnitude(-a); }) ==
        OperationCount{.comparisons = 1, .selections = 1, .negations = 2});
  CHECK(count([&] {
          r = crossbeam::dot(Vec3<C>{a, b, c}, Vec3<C>{c, b, a});
        }) == OperationCount{.additions = 2, .multiplications = 3});
  CHECK(count([&] { r = per_lane(a, [](R x) { return std::cbrt(x); }) + sin(a); }) ==
        OperationCount{.additions = 1, .functions = 2});
  CHECK(count([&] {
          r = a;
          r += b;
          r -= c;
          r *= b;
          r /= c;
        }) == OperationCount{.additions = 2, .multiplications = 1, .divisions = 1});
  CHECK(count([&] { r = C(R(2) * R(3)); }) == OperationCount{});

  const OperationCount all{1, 2, 4, 8, 16, 32, 64, 128};
  CHECK(all.flops() == 15);
  CHECK((all - all) == OperationCount{});
}

TEST_CASE("every thread counts for itself") {
  crossbeam::reset_operation_count();
  std::thread([] { static_cast<void>(Counting<double>(1) + Counting<double>(2)); }).join();
  CHECK(crossbeam::operation_count() == OperationCount{});
}

TEST_CASE("a dual number of counting numbers counts the derivatives too") {
  using D = crossbeam::Dual<Counting<double>, 2>;
  const D x = D::variable(Counting<double>(3), 0), y = D::variable(Counting<double>(4), 1);
  D product;
  CHECK(count([&] { product = x * y; }) == OperationCount{.additions = 2, .multiplications = 5});
  CHECK(product.d[0].v == 4);
  CHECK(product.d[1].v == 3);
}

TEST_CASE_TEMPLATE("the kernels on counting numbers answer as on plain ones, at one price", R,
                   float, double) {
  using C = Counting<R>;
  std::mt19937_64 random(20261127);
  std::uniform_real_distribution<double> elongation(-0.02, 0.03), shear(-0.7, 0.7);
  const crossbeam::CrossedBeamCell<R> cell(crossbeam::CellParameters<double>{}.cast<R>());
  const auto two = SolverControl::fixed(2), three = SolverControl::fixed(3);
  const auto law = membrane<R>(three);
  OperationCount of_cell, of_element, of_shorter;
  for (int sample = 0; sample < 200; ++sample) {
    CAPTURE(sample);
    const double warp = elongation(random), weft = elongation(random), gamma = shear(random);
    const R u1 = R(2.5 * warp), u2 = R(2.5 * weft);
    const auto plain = cell.solve(u1, u2, three);
    typename crossbeam::CrossedBeamCell<R>::template Solution<C> counted;
    const auto now = count([&] { counted = cell.solve(C(u1), C(u2), three); });
    CHECK(counted.forces.F1.v == plain.forces.F1);
    CHECK(counted.forces.F2.v == plain.forces.F2);
    CHECK(counted.forces.w1.v == plain.forces.w1);
    CHECK(counted.forces.q.v == plain.forces.q);
    const auto shorter = count([&] { static_cast<void>(cell.solve(C(u1), C(u2), two)); });
    std::vector<C> forces;
    const auto whole = count([&] { forces = corner_forces<C>(law, warp, weft, gamma); });
    check_equal(forces, corner_forces<R>(law, warp, weft, gamma));
    if (sample == 0) {
      of_cell = now;
      of_element = whole;
      of_shorter = shorter;
    }
    CHECK(now == of_cell);
    CHECK(whole == of_element);
    CHECK(shorter == of_shorter);
  }
  CHECK(of_shorter.flops() > 0);
  CHECK(of_cell.flops() > of_shorter.flops());
  CHECK(of_element.flops() > of_cell.flops());
}

TEST_CASE("the tools on counting numbers answer as on plain ones, at one price") {
  using C = Counting<double>;
  const crossbeam::StadiumRing<double> ring;
  const crossbeam::HeightTable<double> table(
      [](double x, double y) { return std::cos(0.1 * x) * std::cos(0.07 * y); },
      {.x0 = 0, .x1 = 20, .y0 = 0, .y1 = 30, .spacing = 1, .mirror_x = true});
  std::mt19937_64 random(20261128);
  std::uniform_real_distribution<double> place(-150, 150), height(-4, 10);
  OperationCount of_ring, of_table;
  for (int sample = 0; sample < 200; ++sample) {
    CAPTURE(sample);
    const double x = place(random), y = place(random), z = height(random);
    std::vector<C> gap;
    const auto ring_now = count([&] { gap = gap_of<C>(ring, x, y, z); });
    check_equal(gap, gap_of<double>(ring, x, y, z));
    crossbeam::HeightSample<C> sample_counted;
    const auto table_now = count([&] { sample_counted = table.height(C(x / 10), C(y / 10)); });
    const auto plain = table.height(x / 10, y / 10);
    check_equal<double>({sample_counted.h, sample_counted.h_x, sample_counted.h_y},
                        {plain.h, plain.h_x, plain.h_y});
    if (sample == 0) {
      of_ring = ring_now;
      of_table = table_now;
    }
    CHECK(ring_now == of_ring);
    CHECK(table_now == of_table);
  }
  CHECK(of_ring.square_roots == 2);
  CHECK(of_table.flops() > 0);
}

static_assert(std::is_same_v<crossbeam::real_t<Counting<float>>, float>);
static_assert(crossbeam::lanes_v<Counting<double>> == 1);

TEST_SUITE_END();
