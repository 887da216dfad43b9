/// @file
/// The Gauss point: fibre strain -> cell -> energy, stress, tangent; and with the element around it,
/// corner positions -> corner forces.
///
///   gauss_point/<what>/<law>/<iterated how>/<number>
///
/// Laws: `measured_shear`, the energy cell with the shear curve of the scene `realistic`;
/// `constant_shear`, the energy cell with Eq. 26; `second_order`, the paper's cell with Eq. 26.
/// `paper_*` are the yardstick: Eq. 1-20 and 24-27 in plain Eigen (support/paper_baseline.hpp).

#include "support/fabric.hpp"
#include "support/lanes.hpp"
#include "support/paper_baseline.hpp"
#include "support/report.hpp"
#include "support/ring.hpp"

#include "crossbeam/base/dual.hpp"
#include "crossbeam/element/membrane.hpp"
#include "crossbeam/element/quadrilateral.hpp"

#include <cmath>
#include <numbers>
#include <string>

namespace bench {
namespace {

using crossbeam::CrossedBeamCell;
using crossbeam::Dual;
using crossbeam::FibreStrain;
using crossbeam::FibreStress;
using crossbeam::real_t;
using crossbeam::SecondOrderCell;
using crossbeam::SolverControl;
using crossbeam::Vec3;

/// Runs `kernel(strain)` over the ring.
template <class T, class Kernel>
void time_points(benchmark::State& state, const Kernel& kernel) {
  const Ring<real_t<T>> ring;
  for (auto _ : state)
    for (int k = 0; k < ring_size; k += crossbeam::lanes_v<T>) {
      if constexpr (crossbeam::ScalarTraits<T>::derivative_order == 0)
        benchmark::DoNotOptimize(kernel(
            FibreStrain<T>{load<T>(ring.b11, k), load<T>(ring.b22, k), load<T>(ring.b12, k)}));
      else
        benchmark::DoNotOptimize(kernel(FibreStrain<T>{load_variable<T>(ring.b11, k, 0),
                                                       load_variable<T>(ring.b22, k, 1),
                                                       load_variable<T>(ring.b12, k, 2)}));
    }
  report(state, ring_size, "time_per_point");
}

/// A square element of edge 1 mm with one point, as in Ring, its constants in every lane.
template <class T>
struct UnitElement {
  using Quad = crossbeam::Quadrilateral<1>;
  crossbeam::PointLanes<T, Quad::membrane_vectors> point;

  UnitElement() {
    using R = real_t<T>;
    const auto constants = Quad::coefficients<R>(
        {{{R(0), R(0), R(0)}, {R(1), R(0), R(0)}, {R(1), R(1), R(0)}, {R(0), R(1), R(0)}}},
        {{R(1), R(0), R(0)}, {R(0), R(1), R(0)}})[0];
    for (std::size_t k = 0; k < Quad::membrane_vectors; ++k) {
      point.t1[k] = T(constants.t1[k]);
      point.t2[k] = T(constants.t2[k]);
    }
    point.weight = T(constants.weight);
  }
};

template <class T>
struct QuadForces {
  Vec3<T> corner[4];
};

/// Positions -> strain -> cell -> stress -> corner forces, without hourglass control.
template <class T, class Law>
CROSSBEAM_INLINE QuadForces<T> corner_forces(const Law& law, const UnitElement<T>& element,
                                             const Ring<real_t<T>>& ring, int k) {
  using Quad = crossbeam::Quadrilateral<1>;
  Vec3<T> x[4], D[3], force[3]{};
  for (std::size_t a = 0; a < 4; ++a)
    x[a] = {load<T>(ring.corner[a].x, k), load<T>(ring.corner[a].y, k),
            load<T>(ring.corner[a].z, k)};
  Quad::relative_vectors(x, D);
  const crossbeam::PointKinematics<T, Quad::membrane_vectors, 3> kinematics(D, element.point);
  const auto at = law.evaluate(kinematics.strain(law.reference().cosine));
  add_point_forces(kinematics, law.stress(at), element.point, force);
  QuadForces<T> out;
  Quad::corner_forces(force, out.corner);
  return out;
}

template <class T>
struct StressAndTangent {
  FibreStress<T> stress;
  crossbeam::StrainHessian<T> tangent;
};

/// Name of a benchmark of one law in one number type.
template <class T>
auto namer(std::string law, std::string iterated) {
  return [law = std::move(law), iterated = std::move(iterated)](const char* what) {
    return std::string("gauss_point/") + what + "/" + law + "/" + iterated + "/" + number_name<T>();
  };
}

/// What every law has.
template <class T, class Law>
void register_forces(const std::string& law_name, const std::string& iterated, const Law& law) {
  const auto name = namer<T>(law_name, iterated);
  benchmark::RegisterBenchmark(name("forces").c_str(), [law](benchmark::State& state) {
    time_points<T>(state,
                   [&](const FibreStrain<T>& beta) { return law.stress(law.evaluate(beta)); });
  });
  benchmark::RegisterBenchmark(name("corner_forces").c_str(), [law](benchmark::State& state) {
    const Ring<real_t<T>> ring;
    const UnitElement<T> element;
    for (auto _ : state)
      for (int k = 0; k < ring_size; k += crossbeam::lanes_v<T>)
        benchmark::DoNotOptimize(corner_forces<T>(law, element, ring, k));
    report(state, ring_size, "time_per_point");
  });
}

/// What needs a potential; the derivatives once by hand and once by dual numbers.
template <class T, class Law>
void register_derivatives(const std::string& law_name, const std::string& iterated,
                          const Law& law) {
  const auto name = namer<T>(law_name, iterated);
  using D = Dual<T, 3>;
  const auto energy = [law](const auto& beta) {
    const auto at = law.evaluate(beta);
    return law.yarn_energy(at) + law.shear_energy(at);
  };
  benchmark::RegisterBenchmark(
      name("energy").c_str(), [energy](benchmark::State& state) { time_points<T>(state, energy); });
  benchmark::RegisterBenchmark(name("forces_autodiff").c_str(), [energy](benchmark::State& state) {
    time_points<D>(state, energy);
  });
  benchmark::RegisterBenchmark(name("forces_and_tangent").c_str(), [law](benchmark::State& state) {
    time_points<T>(state, [&](const FibreStrain<T>& beta) {
      const auto at = law.evaluate(beta);
      return StressAndTangent<T>{law.stress(at), law.hessian(at)};
    });
  });
  benchmark::RegisterBenchmark(
      name("forces_and_tangent_autodiff").c_str(), [law](benchmark::State& state) {
        time_points<D>(state,
                       [&](const FibreStrain<D>& beta) { return law.stress(law.evaluate(beta)); });
      });
}

/// The yardstick, after a check that it answers as the library's second-order law does.
template <paper::Solver solver>
void paper_point(benchmark::State& state) {
  const paper::Membrane law(cell_parameters<double>(), shear_modulus, 0, std::numbers::pi / 2);
  const auto same = membrane(SecondOrderCell<double>(cell_parameters<double>()),
                             constant_shear<double>(), SolverControl::converged());
  const Ring<double> ring;
  const auto strain = [&](int k) {
    const auto i = static_cast<std::size_t>(k);
    Eigen::Matrix2d E;
    E << ring.b11[i], ring.b12[i], ring.b12[i], ring.b22[i];
    return E;
  };
  for (int k = 0; k < ring_size; ++k) {
    const Eigen::Matrix2d E = strain(k), S = law.stress<solver>(E);
    const auto at = same.evaluate(FibreStrain<double>{E(0, 0), E(1, 1), E(0, 1)});
    const auto m = same.stress(at);
    if (at.cell.fallback == 0 &&
        !(std::abs(S(0, 0) - m.m11) < 1e-10 && std::abs(S(1, 1) - m.m22) < 1e-10 &&
          std::abs(S(0, 1) - m.m12) < 1e-10))
      return state.SkipWithError("the yardstick differs from the second-order law");
  }
  for (auto _ : state)
    for (int k = 0; k < ring_size; ++k) benchmark::DoNotOptimize(law.stress<solver>(strain(k)));
  report(state, ring_size, "time_per_point");
}

template <paper::Solver solver>
void paper_corner_forces(benchmark::State& state) {
  const paper::Membrane law(cell_parameters<double>(), shear_modulus, 0, std::numbers::pi / 2);
  const auto same = membrane(SecondOrderCell<double>(cell_parameters<double>()),
                             constant_shear<double>(), SolverControl::converged());
  const Ring<double> ring;
  const UnitElement<double> element;
  paper::Corners X;
  X << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0;
  const auto corners = [&](int k) {
    paper::Corners x;
    for (std::size_t a = 0; a < 4; ++a) {
      const auto p = ring.corner[a].get(k);
      x.col(static_cast<Eigen::Index>(a)) << p.x, p.y, p.z;
    }
    return x;
  };
  for (int k = 0; k < ring_size; ++k) {
    const paper::Corners f = law.corner_forces<solver>(X, corners(k));
    const auto expected = corner_forces<double>(same, element, ring, k);
    for (int a = 0; a < 4; ++a) {
      const auto& e = expected.corner[a];
      if (!((f.col(a) - Eigen::Vector3d(e.x, e.y, e.z)).norm() < 1e-10))
        return state.SkipWithError("the yardstick differs from the second-order law");
    }
  }
  for (auto _ : state)
    for (int k = 0; k < ring_size; ++k)
      benchmark::DoNotOptimize(law.corner_forces<solver>(X, corners(k)));
  report(state, ring_size, "time_per_point");
}

template <paper::Solver solver>
void register_paper(const std::string& name) {
  benchmark::RegisterBenchmark(("gauss_point/forces/" + name + "/converged/double").c_str(),
                               paper_point<solver>);
  benchmark::RegisterBenchmark(("gauss_point/corner_forces/" + name + "/converged/double").c_str(),
                               paper_corner_forces<solver>);
}

[[maybe_unused]] const bool registered = [] {
  record_build();
  register_paper<paper::Solver::lu_4x4>("paper_lu_4x4");
  register_paper<paper::Solver::inverse_2x2>("paper_inverse_2x2");
  for_each_number([]<class T>() {
    using R = real_t<T>;
    const CrossedBeamCell<R> cell(cell_parameters<R>());
    const auto converged = SolverControl::converged();
    // What the loop costs itself: strains in, strains out.
    benchmark::RegisterBenchmark(
        ("gauss_point/nothing/" + number_name<T>()).c_str(), [](benchmark::State& state) {
          time_points<T>(state, [](const FibreStrain<T>& beta) { return beta; });
        });
    register_forces<T>(
        "second_order", "converged",
        membrane(SecondOrderCell<R>(cell_parameters<R>()), constant_shear<R>(), converged));
    register_forces<T>("constant_shear", "3_sweeps",
                       membrane(cell, constant_shear<R>(), SolverControl::fixed(3)));
    const auto add = [&](const char* iterated, SolverControl control) {
      const auto law = membrane(cell, measured_shear<R>(), control);
      register_forces<T>("measured_shear", iterated, law);
      register_derivatives<T>("measured_shear", iterated, law);
    };
    add("converged", converged);
    add("3_sweeps", SolverControl::fixed(3));
    add("2_sweeps", SolverControl::fixed(2));
  });
  return true;
}();

}  // namespace
}  // namespace bench
