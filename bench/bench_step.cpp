/// @file
/// One whole step of the explicit scheme (forces, velocities, positions) on a flat taut sheet that
/// vibrates: no contact. Options are left out one at a time from what the scene `realistic` uses;
/// `one_by_one` has no two steps in flight; `policies` are the same with the options of cell and
/// element fixed at compile time (support/policies.hpp).
///
///   step/<elements>/<options>/<number>

#include "support/fabric.hpp"
#include "support/policies.hpp"
#include "support/report.hpp"
#include "support/work.hpp"

#include "crossbeam/dynamics/central_difference.hpp"
#include "crossbeam/mesh/numbering.hpp"
#include "crossbeam/sweep/bending_sweep.hpp"
#include "crossbeam/sweep/membrane_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace bench {
namespace {

using crossbeam::CentralDifference;
using crossbeam::NativePack;
using crossbeam::NodalState;
using crossbeam::Pack;
using crossbeam::real_t;

struct Sheet {
  int nx, ny;
  [[nodiscard]] int elements() const { return nx * ny; }
};

struct Options {
  int points = 1;             ///< 1 or 4
  bool unstructured = false;  ///< elements and nodes in random order, then numbered by levels
  bool bending = true, viscosity = true, hourglass = true;
  bool in_flight = true;  ///< several steps together, where the mesh is large enough
};
constexpr Options bare{.bending = false, .viscosity = false, .hourglass = false};

/// Nodes and elements in an order drawn by lot.
crossbeam::Numbering shuffled(const crossbeam::Mesh<4>& mesh) {
  std::mt19937_64 random(1);
  crossbeam::Numbering out;
  out.node.resize(static_cast<std::size_t>(mesh.node_count));
  out.element.resize(static_cast<std::size_t>(mesh.element_count()));
  for (auto* list : {&out.node, &out.element}) {
    std::iota(list->begin(), list->end(), 0);
    std::shuffle(list->begin(), list->end(), random);
  }
  return out;
}

/// A sheet of 5 mm elements, stretched by 0.5 % and held along its edges, with a smooth speed out
/// of its plane: taut, moving, and far from the tiny numbers that slow a processor down.
/// @tparam Cell CrossedBeamCell or FixedCell; @tparam Quad one-point quadrilateral
template <class T, class Cell, class Quad>
CentralDifference<T> vibrating_sheet(const Sheet& sheet, const Options& options) {
  using R = real_t<T>;
  const double edge = 5, width = edge * sheet.nx, length = edge * sheet.ny, prestretch = 1.005;
  auto mesh = crossbeam::rectangle(width, length, sheet.nx, sheet.ny);
  if (options.unstructured) {
    mesh = crossbeam::renumbered(mesh, shuffled(mesh));
    mesh = crossbeam::renumbered(mesh, crossbeam::number_by_levels(mesh));
  }
  std::vector<crossbeam::NodeConstraint> held;
  for (int n = 0; n < mesh.node_count; ++n) {
    const auto X = mesh.nodes.get(n);
    if (X.x == 0 || X.x == width || X.y == 0 || X.y == length)
      held.push_back({n, true, true, true});
  }
  NodalState<R> state(mesh, areal_mass, held);
  for (int n = 0; n < mesh.node_count; ++n) {
    const auto X = mesh.nodes.get(n);
    state.x.set(n, {prestretch * X.x, prestretch * X.y, 0});
    const double wave =
        std::sin(std::numbers::pi * X.x / width) * std::sin(std::numbers::pi * X.y / length);
    state.v.set(n, {R(0), R(0), R(wave) * state.free.z[static_cast<std::size_t>(n)]});
  }
  crossbeam::Model<R> model(std::move(state));
  const crossbeam::WovenMembrane<Cell, crossbeam::PolynomialShear<R>,
                                 crossbeam::CellPrice::followed>
      law(Cell(cell_parameters<R>()), measured_shear<R>());
  const crossbeam::MembraneOptions membrane_options{options.hourglass ? hourglass_modulus : 0,
                                                    options.viscosity ? bulk_viscosity : 0};
  const auto add_membrane = [&]<class Element>() {
    using Block = crossbeam::MembraneSweep<T, Element, std::decay_t<decltype(law)>>;
    model.add(std::make_unique<Block>(mesh, law, areal_mass, membrane_options));
  };
  if (options.points == 1)
    add_membrane.template operator()<Quad>();
  else
    add_membrane.template operator()<crossbeam::Quadrilateral<4>>();
  if (options.bending)
    model.add(std::make_unique<crossbeam::BendingSweep<T>>(
        mesh, crossbeam::BendingStiffness{bending_stiffness, bending_stiffness}, areal_mass));
  CentralDifference<T> integrator(std::move(model), crossbeam::TimeStep::fraction(0.9));
  for (int n = 0; n < 3; ++n) integrator.step();  // the first also evaluates the energy
  return integrator;
}

/// Flops of one element and step, counted on the sheet or, where it is larger, on
/// `largest_counted`.
constexpr Sheet largest_counted{100, 200};

template <class R, class Cell, class Quad>
double step_flops(Sheet sheet, const Options& options) {
  if (sheet.elements() > largest_counted.elements()) sheet = largest_counted;
  auto integrator = vibrating_sheet<crossbeam::Counting<R>, Cell, Quad>(sheet, options);
  crossbeam::reset_operation_count();
  integrator.step();
  return static_cast<double>(crossbeam::operation_count().flops()) / sheet.elements();
}

/// Whether the nodal forces of two sheets agree, to 1e-4 of the largest.
template <class T>
bool same_forces(const CentralDifference<T>& a, const CentralDifference<T>& b) {
  double difference = 0, largest = 0;
  for (int n = 0; n < a.state().node_count; ++n) {
    const auto f = a.state().f.get(n), off = f - b.state().f.get(n);
    largest = std::max(largest, static_cast<double>(dot(f, f)));
    difference += static_cast<double>(dot(off, off));
  }
  return largest > 0 && difference <= 1e-8 * largest;
}

/// The sheet is set up at the first of a benchmark's repetitions and keeps vibrating in the others.
template <class T, class Cell = crossbeam::CrossedBeamCell<real_t<T>>,
          class Quad = crossbeam::Quadrilateral<1>>
void register_step(const Sheet& sheet, const std::string& what, const Options& options,
                   int threads = 0) {
  using Standard = crossbeam::CrossedBeamCell<real_t<T>>;
  const std::string name =
      "step/" + std::to_string(sheet.elements()) + "/" + what + "/" + number_name<T>();
  const auto integrator = std::make_shared<std::unique_ptr<CentralDifference<T>>>();
  auto* registered = benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    if (!*integrator) {
      *integrator =
          std::make_unique<CentralDifference<T>>(vibrating_sheet<T, Cell, Quad>(sheet, options));
      if constexpr (!std::is_same_v<Cell, Standard>)
        if (!same_forces(**integrator,
                         vibrating_sheet<T, Standard, crossbeam::Quadrilateral<1>>(sheet, options)))
          return state.SkipWithError("the policies change the forces");
    }
    if (threads > 0) (*integrator)->set_threads(threads);
    constexpr int steps = 4;  // as many as are in flight at a time
    for (auto _ : state) {
      if (options.in_flight)
        (*integrator)->advance(steps);
      else
        for (int n = 0; n < steps; ++n) (*integrator)->step();
    }
    report(state, steps * sheet.elements(), "time_per_element_step");
    // The peak is that of one core.
    if (threads == 0)
      report_work<real_t<T>>(state, steps * sheet.elements(),
                             {step_flops<real_t<T>, Cell, Quad>(sheet, options)});
  });
  registered->Unit(benchmark::kMicrosecond);
  if (threads > 0) registered->UseRealTime();
}

template <class T>
void register_options(const Sheet& sheet) {
  register_step<T>(sheet, "full", {});
  register_step<T>(sheet, "no_bending", {.bending = false});
  register_step<T>(sheet, "no_viscosity", {.viscosity = false});
  register_step<T>(sheet, "no_hourglass", {.hourglass = false});
  register_step<T>(sheet, "bare", bare);
  register_step<T>(sheet, "4_points", {.points = 4, .hourglass = false});
  register_step<T>(sheet, "4_points_bare",
                   {.points = 4, .bending = false, .viscosity = false, .hourglass = false});
}

template <class T>
void register_policies(const Sheet& sheet) {
  using Cell = FixedCell<real_t<T>>;
  register_step<T, Cell>(sheet, "full/policies", {});
  register_step<T, Cell, QuadWithoutHourglass>(sheet, "bare/policies", bare);
}

[[maybe_unused]] const bool registered = [] {
  record_build();
  const Sheet dome{26, 50}, medium{100, 200}, large{260, 500};
  for (const Sheet& sheet : {dome, medium}) {
    register_options<NativePack<double>>(sheet);
    register_options<NativePack<float>>(sheet);
  }
  register_policies<NativePack<double>>(dome);
  register_policies<NativePack<float>>(dome);
  register_step<NativePack<double>>(medium, "unstructured", {.unstructured = true});
  register_step<NativePack<double>>(Sheet{1050, 1050}, "full", {});
  register_step<NativePack<double>>(Sheet{1050, 1050}, "one_by_one", {.in_flight = false});
  for (const int threads : {1, 2})
    register_step<NativePack<double>>(large, std::to_string(threads) + "_threads", {}, threads);
  for (const char* what : {"full", "bare"}) {
    const Options options = std::string(what) == "full" ? Options{} : bare;
    register_step<NativePack<double>>(large, what, options);
    register_step<NativePack<float>>(large, what, options);
    register_step<Pack<double, 1>>(dome, what, options);
  }
  return true;
}();

}  // namespace
}  // namespace bench
