/// @file
/// The membrane part of an element, corner positions to corner forces, without hourglass control.
///
///   element/<element>/<law>/<iterated how>/<number>
///
/// Laws as in bench_gauss_point.cpp; `paper_*` are the yardstick (support/paper_element.hpp), with
/// its one-point quadrilateral.

#include "support/element_forces.hpp"
#include "support/fabric.hpp"
#include "support/paper_element.hpp"
#include "support/report.hpp"

#include <string>

namespace bench {
namespace {

using crossbeam::real_t;
using crossbeam::SolverControl;

const char* const per_element = "time_per_element";

template <class T, class Element, class Law>
void register_element(const std::string& element, const std::string& law_name, const Law& law) {
  const std::string name = "element/" + element + "/" + law_name + "/3_sweeps/" + number_name<T>();
  benchmark::RegisterBenchmark(name.c_str(), [law](benchmark::State& state) {
    time_corner_forces<T, Element>(state, law, random_states(), per_element);
  });
}

template <class T, class Law>
void register_law(const std::string& law_name, const Law& law) {
  register_element<T, crossbeam::Quadrilateral<1>>("quadrilateral_1_point", law_name, law);
  register_element<T, crossbeam::Quadrilateral<4>>("quadrilateral_4_points", law_name, law);
  register_element<T, crossbeam::Triangle>("triangle", law_name, law);
}

template <Start start>
void register_paper(const char* name) {
  benchmark::RegisterBenchmark(
      ("element/quadrilateral_1_point/" + std::string(name) + "/converged/double").c_str(),
      [](benchmark::State& state) {
        paper_corner_forces<paper::Solver::inverse_2x2, start>(state, per_element);
      });
}

[[maybe_unused]] const bool registered = [] {
  record_build();
  register_paper<Start::cold>("paper_inverse_2x2");
  register_paper<Start::warm>("paper_inverse_2x2_warm");
  for_each_number([]<class T>() {
    using R = real_t<T>;
    const crossbeam::CrossedBeamCell<R> cell(cell_parameters<R>());
    register_law<T>("constant_shear", membrane(cell, constant_shear<R>(), SolverControl::fixed(3)));
    register_law<T>("measured_shear", membrane(cell, measured_shear<R>(), SolverControl::fixed(3)));
  });
  return true;
}();

}  // namespace
}  // namespace bench
