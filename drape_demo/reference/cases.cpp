#include "cases.hpp"

#include <cmath>
#include <utility>

namespace crossbeam::drape {

template <class R>
Case<R> sphere_case(const SphereSheet& sheet) {
  return {sheet.model<R>(), sheet.mesh(), sheet.elements, sheet.elements, 1.2 * sheet.duration};
}

template <class R>
Case<R> dome_case(const DrapeCase& c) {
  QuarterModel<R> quarter(c);
  const int nx = quarter.grid().nx, ny = quarter.grid().ny;
  const double duration = quarter.punch().duration * (1 + c.process.hold);
  Mesh<4> mesh = quarter.mesh();
  return {quarter.release(), std::move(mesh), nx, ny, duration};
}

template <class Integrator>
Frames integrate(Case<double> c, const reference::Tolerances& tolerances) {
  const double begin = processor_seconds();
  Integrator integrator(c.model, tolerances);
  Frames out;
  for (int k = 1; k <= 10; ++k) {
    integrator.advance(c.duration * k / 10);
    out.at.push_back(c.formed());
  }
  out.processor_s = processor_seconds() - begin;
  out.steps = integrator.statistics().steps;
  out.evaluations = integrator.statistics().evaluations;
  return out;
}

template <class R>
Frames explicit_run(Case<R> c, double step_factor) {
  const double begin = processor_seconds();
  const double least = step_factor * c.model.critical_step();
  const long steps = static_cast<long>(std::ceil(c.duration / 10 / least));
  CentralDifference<NativePack<R>> run(
      std::move(c.model), TimeStep::fixed(c.duration / 10 / static_cast<double>(steps)));
  Frames out;
  for (int k = 1; k <= 10; ++k) {
    run.advance(steps);
    out.at.push_back(formed_state(run.model(), c.mesh, c.nx, c.ny));
  }
  out.processor_s = processor_seconds() - begin;
  out.steps = out.evaluations = run.steps();
  return out;
}

template Case<double> sphere_case(const SphereSheet&);
template Case<float> sphere_case(const SphereSheet&);
template Case<double> dome_case(const DrapeCase&);
template Case<float> dome_case(const DrapeCase&);
template Frames integrate<reference::RungeKutta5>(Case<double>, const reference::Tolerances&);
template Frames integrate<reference::Adams>(Case<double>, const reference::Tolerances&);
template Frames integrate<reference::BackwardDifferences>(Case<double>,
                                                          const reference::Tolerances&);
template Frames explicit_run(Case<double>, double);
template Frames explicit_run(Case<float>, double);

}  // namespace crossbeam::drape
