// The kernels as device code: from the corners of an element to its corner forces, one element a
// thread, and energies and tangents of a point, by the very functions that run on the processor.
// Compiled without fused multiply-adds on either side, both compute with the same correctly rounded
// operations: the answers are equal in every bit. Exit code 77: no GPU here, only compiled.

#include "crossbeam/base/dual.hpp"
#include "crossbeam/cell/crossed_beam.hpp"
#include "crossbeam/cell/second_order.hpp"
#include "crossbeam/element/membrane.hpp"
#include "crossbeam/element/quadrilateral.hpp"
#include "crossbeam/element/triangle.hpp"
#include "crossbeam/law/shear.hpp"
#include "crossbeam/law/woven_membrane.hpp"
#include "crossbeam/tools/stadium_ring.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>
#include <type_traits>
#include <vector>

namespace {

using namespace crossbeam;

template <class R, class Element>
struct Input {
  Vec3<R> corner[Element::corners];
  PointLanes<R, Element::membrane_vectors> point[Element::points];
};

template <class R, class Element>
struct Output {
  Vec3<R> force[Element::corners];
  R gap;
};

template <class R, class Element, class Law>
CROSSBEAM_INLINE Output<R, Element> element_forces(const Law& law, const StadiumRing<R>& ring,
                                                   const Input<R, Element>& input) {
  constexpr int K = Element::vectors, M = Element::membrane_vectors;
  Vec3<R> D[K], force[K]{};
  Element::relative_vectors(input.corner, D);
  for (int p = 0; p < Element::points; ++p) {
    const PointKinematics<R, M, K> kinematics(D, input.point[p]);
    const auto state = law.evaluate(kinematics.strain(law.reference().cosine));
    add_point_forces(kinematics, law.stress(state), input.point[p], force);
  }
  Output<R, Element> output;
  Element::corner_forces(force, output.force);
  output.gap = ring.gap(input.corner[0]).gap;
  return output;
}

/// What a point has besides its stress; the derivative of the stress by beta11 from dual numbers.
template <class R>
struct PointOutput {
  R yarn_energy, shear_energy;
  StrainHessian<R> hessian;
  R slope;
};

template <class R, class Law>
CROSSBEAM_INLINE PointOutput<R> point_output(const Law& law, const FibreStrain<R>& beta) {
  using D = Dual<R, 1>;
  const auto state = law.evaluate(beta);
  FibreStrain<D> b{D(beta.b11), D(beta.b22), D(beta.b12)};
  b.b11.d[0] = R(1);
  return {law.yarn_energy(state), law.shear_energy(state), law.hessian(state),
          law.stress(law.evaluate(b)).m11.d[0]};
}

/// The function of a point or an element that a kernel applies in every thread.
template <class R, class Element, class Law>
struct ElementForces {
  using In = Input<R, Element>;
  using Out = Output<R, Element>;
  Law law;
  StadiumRing<R> ring{};
  CROSSBEAM_INLINE Out operator()(const In& input) const {
    return element_forces<R, Element>(law, ring, input);
  }
};
template <class R, class Law>
struct PointValues {
  using In = FibreStrain<R>;
  using Out = PointOutput<R>;
  Law law;
  CROSSBEAM_INLINE Out operator()(const In& input) const { return point_output<R>(law, input); }
};

template <class F>
__global__ void kernel(F function, const typename F::In* input, typename F::Out* output,
                       int count) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < count) output[i] = function(input[i]);
}

constexpr int count = 10000;

/// Elements of about 5 mm, sheared by up to 0.9 rad, their yarns stretched or shortened by up
/// to 3 %, out of plane.
template <class R, class Element>
std::vector<Input<R, Element>> random_elements() {
  constexpr int corners = Element::corners;
  std::mt19937 random(20260301);
  const auto uniform = [&random](double low, double high) {
    return R(std::uniform_real_distribution<double>(low, high)(random));
  };
  std::vector<Input<R, Element>> elements(count);
  for (auto& element : elements) {
    std::array<Vec3<R>, corners> X;
    for (int a = 0; a < corners; ++a)
      X[a] = {R(a == 1 || a == 2 ? 5 : 0) + uniform(-0.5, 0.5),
              R(a >= 2 ? 5 : 0) + uniform(-0.5, 0.5), R(0)};
    const FibreDirections<R> fibres{{R(1), R(0), R(0)}, {R(0), R(1), R(0)}};
    const auto coefficients = Element::coefficients(X, fibres);
    for (int p = 0; p < Element::points; ++p) {
      for (int k = 0; k < Element::membrane_vectors; ++k) {
        element.point[p].t1[k] = coefficients[p].t1[k];
        element.point[p].t2[k] = coefficients[p].t2[k];
      }
      element.point[p].weight = coefficients[p].weight;
    }
    const R gamma = uniform(-0.9, 0.9), turn = uniform(-3, 3);
    const R l1 = uniform(0.97, 1.03), l2 = uniform(0.97, 1.03);
    const Vec3<R> f1{l1 * std::cos(turn), l1 * std::sin(turn), R(0)};
    const Vec3<R> f2{l2 * std::sin(gamma - turn), l2 * std::cos(gamma - turn), R(0)};
    const Vec3<R> place{uniform(-150, 150), uniform(-250, 250), uniform(-10, 10)};
    for (int a = 0; a < corners; ++a)
      element.corner[a] =
          place + X[a].x * f1 + X[a].y * f2 + Vec3<R>{R(0), R(0), uniform(-0.05, 0.05)};
  }
  return elements;
}

/// Strains of yarns stretched or shortened by up to 3 %, sheared by up to 0.9 rad.
template <class R>
std::vector<FibreStrain<R>> random_strains() {
  std::mt19937 random(20260302);
  const auto uniform = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<FibreStrain<R>> strains(count);
  for (auto& beta : strains) {
    const double l1 = uniform(0.97, 1.03), l2 = uniform(0.97, 1.03), gamma = uniform(-0.9, 0.9);
    beta = {R(0.5 * (l1 * l1 - 1)), R(0.5 * (l2 * l2 - 1)), R(0.5 * l1 * l2 * std::sin(gamma))};
  }
  return strains;
}

bool succeeded(cudaError_t status, const char* what) {
  if (status == cudaSuccess) return true;
  std::printf("device: %s: %s\n", what, cudaGetErrorString(status));
  return false;
}

/// Whether device and host agree in every bit; prints the largest difference. Everything that a
/// kernel here returns is numbers of type R.
template <class R, class F>
bool compare(const char* name, const F& function, const std::vector<typename F::In>& inputs) {
  using In = typename F::In;
  using Out = typename F::Out;
  constexpr int threads = 128;
  constexpr std::size_t numbers = sizeof(Out) / sizeof(R);
  std::vector<Out> answers(count);
  void *input = nullptr, *output = nullptr;
  if (!succeeded(cudaMalloc(&input, count * sizeof(In)), "cudaMalloc") ||
      !succeeded(cudaMalloc(&output, count * sizeof(Out)), "cudaMalloc") ||
      !succeeded(cudaMemcpy(input, inputs.data(), count * sizeof(In), cudaMemcpyHostToDevice),
                 "cudaMemcpy"))
    return false;
  kernel<<<(count + threads - 1) / threads, threads>>>(function, static_cast<const In*>(input),
                                                       static_cast<Out*>(output), count);
  if (!succeeded(cudaGetLastError(), "launch") ||
      !succeeded(cudaMemcpy(answers.data(), output, count * sizeof(Out), cudaMemcpyDeviceToHost),
                 "run") ||
      !succeeded(cudaFree(input), "cudaFree") || !succeeded(cudaFree(output), "cudaFree"))
    return false;

  R largest(0), largest_difference(0);
  int unequal = 0;
  for (int i = 0; i < count; ++i) {
    const Out here = function(inputs[i]);
    R host[numbers], device[numbers];
    std::memcpy(host, &here, sizeof here);
    std::memcpy(device, &answers[i], sizeof here);
    for (std::size_t k = 0; k < numbers; ++k) {
      largest = std::max(largest, std::abs(host[k]));
      largest_difference = std::max(largest_difference, std::abs(device[k] - host[k]));
    }
    unequal += std::memcmp(host, device, sizeof host) != 0;
  }
  std::printf(
      "device: %s, %s: %d threads, largest number %.3g, largest difference %.3g, "
      "%d not equal in every bit\n",
      sizeof(R) == 8 ? "double" : "float", name, count, double(largest), double(largest_difference),
      unequal);
  return unequal == 0 && largest > R(0);
}

template <class R>
bool compare_all() {
  using Quad = Quadrilateral<1>;
  const CellParameters<R> parameters;
  const auto angle = FibreAngle<R>::right();
  const auto fixed = SolverControl::fixed(3);
  const CrossedBeamCell<R> cell(parameters);
  const PolynomialShear<R> polynomial(PolynomialCurve<R>({R(1e-4), R(0), R(2e-3)}));
  const ConstantShear<R> constant(R(1e-3));
  const auto law = [&](const auto& unit_cell, const auto& shear, SolverControl control) {
    return WovenMembrane(unit_cell, shear, angle, YarnWidth::corrected, control);
  };
  int failures = 0;
  const auto elements = [&]<class Element>(const char* name, Element, const auto& of) {
    using F = ElementForces<R, Element, std::decay_t<decltype(of)>>;
    failures += !compare<R>(name, F{of}, random_elements<R, Element>());
  };
  const auto points = [&](const char* name, const auto& of) {
    using F = PointValues<R, std::decay_t<decltype(of)>>;
    failures += !compare<R>(name, F{of}, random_strains<R>());
  };
  elements("quadrilateral, polynomial shear", Quad(), law(cell, polynomial, fixed));
  elements("quadrilateral, constant shear", Quad(), law(cell, constant, fixed));
  elements("quadrilateral, to convergence", Quad(),
           law(cell, constant, SolverControl::converged()));
  elements("quadrilateral, second-order cell", Quad(),
           law(SecondOrderCell<R>(parameters), constant, SolverControl::converged()));
  elements("quadrilateral, 2x2 points", Quadrilateral<4>(), law(cell, constant, fixed));
  elements("triangle, no shear layer", Triangle(), law(cell, NoShear<R>(), fixed));
  points("energies and tangents", law(cell, polynomial, fixed));
  points("energies and tangents, bilateral contact",
         law(BilateralCell<R>(parameters), constant, fixed));
  return failures == 0;
}

}  // namespace

int main() {
  int devices = 0;
  if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) {
    std::printf("device: skipped, no GPU here; the kernels were compiled only\n");
    return 77;
  }
  const bool good = compare_all<double>();
  return compare_all<float>() && good ? 0 : 1;
}
