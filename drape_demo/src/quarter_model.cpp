#include "quarter_model.hpp"

#include "crossbeam/crossbeam.hpp"
#include "crossbeam/sweep/membrane_tangent.hpp"
#include "double_dome.hpp"

#include <algorithm>
#include <memory>
#include <random>
#include <type_traits>
#include <vector>

namespace crossbeam::drape {

template <class R>
QuarterModel<R>::QuarterModel(const DrapeCase& c)
    : case_(c),
      grid_(quarter_grid(c.blank)),
      mesh_(rectangle(c.blank.half_width, c.blank.half_length, grid_.nx, grid_.ny,
                      c.blank.layout * std::numbers::pi / 180)),
      punch_{c.process.stroke, c.process.stroke / c.process.speed},
      model_(initial_state(), c.integration.mass_damping) {
  add_membrane();
  if (c.fabric.warp_bending_stiffness > 0 || c.fabric.weft_bending_stiffness > 0)
    model_.add(std::make_unique<BendingSweep<NativePack<R>>>(
        mesh_, BendingStiffness{c.fabric.warp_bending_stiffness, c.fabric.weft_bending_stiffness},
        c.fabric.areal_mass, symmetry_));
  add_tools();
}

template <class R>
NodalState<R> QuarterModel<R>::initial_state() const {
  NodalState<R> state(mesh_, case_.fabric.areal_mass, symmetry_constraints(mesh_, symmetry_));
  if (case_.blank.perturbation > 0) {
    std::mt19937_64 random(case_.blank.seed);
    // Spelled out, so that every standard library gives the same numbers.
    const auto uniform = [&] {
      return case_.blank.perturbation * (static_cast<double>(random() >> 11) * 0x1.0p-52 - 1.0);
    };
    for (int n = 0; n < mesh_.node_count; ++n) {
      const Vec3<double> X = mesh_.nodes.get(n);
      const double dx = uniform(), dy = uniform(), dz = uniform();
      state.x.set(n, {X.x + dx * static_cast<double>(state.free.x[n]),
                      X.y + dy * static_cast<double>(state.free.y[n]), X.z + dz});
    }
  }
  return state;
}

template <class R>
void QuarterModel<R>::add_membrane() {
  CellParameters<double> cell = case_.fabric.cell;
  for (YarnParameters<double>* yarn : {&cell.warp, &cell.weft}) {  // E I stays
    yarn->youngs_modulus /= case_.integration.axial_scaling;
    yarn->second_moment_of_area *= case_.integration.axial_scaling;
  }
  if (case_.fabric.formulation == CellFormulation::energy)
    add_membrane_with(CrossedBeamCell<R>(cell.cast<R>()));
  else
    add_membrane_with(SecondOrderCell<R>(cell.cast<R>()));
}

template <class R>
template <class Cell>
void QuarterModel<R>::add_membrane_with(const Cell& cell) {
  const ShearInput& shear = case_.fabric.shear;
  const auto real = [](const std::vector<double>& v) { return std::vector<R>(v.begin(), v.end()); };
  switch (shear.kind) {
    case ShearLawKind::constant:
      return add_membrane_with(cell, ConstantShear<R>(R(shear.modulus), shear.measure));
    case ShearLawKind::polynomial:
      return add_membrane_with(cell,
                               PolynomialShear<R>(PolynomialCurve<R>(real(shear.coefficients))));
    case ShearLawKind::tabulated:
      return add_membrane_with(
          cell, TabulatedShear<R>(TabulatedCurve<R>(real(shear.angle), real(shear.traction))));
  }
}

template <class R>
template <class Cell, class Shear>
void QuarterModel<R>::add_membrane_with(const Cell& cell, const Shear& shear) {
  if constexpr (std::is_same_v<Cell, CrossedBeamCell<R>>)
    if (case_.fabric.cell_solve == CellSolve::follow)
      return add_membrane_of(WovenMembrane<Cell, Shear, CellPrice::followed>(cell, shear));
  const SolverControl control = case_.fabric.cell_solve == CellSolve::sweeps
                                    ? SolverControl::fixed(case_.fabric.cell_sweeps)
                                    : SolverControl::converged();
  add_membrane_of(WovenMembrane<Cell, Shear>(cell, shear, FibreAngle<R>::right(),
                                             YarnWidth::corrected, control));
}

template <class R>
template <class Law>
void QuarterModel<R>::add_membrane_of(const Law& law) {
  const MembraneOptions options{case_.blank.hourglass_stiffness, case_.integration.bulk_viscosity};
  if (case_.blank.gauss_points == 1)
    add_block<Quadrilateral<1>>(law, options);
  else
    add_block<Quadrilateral<4>>(law, options);
}

template <class R>
template <class Element, class Law>
void QuarterModel<R>::add_block(const Law& law, const MembraneOptions& options) {
  using T = NativePack<R>;
  const double mass = case_.fabric.areal_mass;
  // Of the statics of a formed part (drape_demo/reference), in double and without memory.
  if constexpr (std::is_same_v<R, double> && !Law::follows_heights &&
                MembraneLawWithTangent<Law, T>)
    model_.add(
        std::make_unique<MembraneSweepWithTangent<T, Element, Law>>(mesh_, law, mass, options));
  else
    model_.add(std::make_unique<MembraneSweep<T, Element, Law>>(mesh_, law, mass, options));
}

/// Punch below, die above, holder ring below. The fabric's mid-surface starts on the die flange, at
/// z = 0; the tools' contact surfaces are theirs, moved by half the thickness.
template <class R>
void QuarterModel<R>::add_tools() {
  const double half_thickness = case_.fabric.thickness / 2;
  const double play = 5.0 / 3.0;  // between punch and die when closed, along the normal [mm]
  ContactParameters contact;
  contact.penalty = case_.contact.penalty;
  contact.damping_ratio = case_.contact.damping_ratio;
  contact.friction = case_.contact.friction;
  contact.friction_model = case_.contact.friction_model;
  contact.smoothing = case_.contact.smoothing;
  contact.slip_speed = case_.contact.viscous_slip * case_.process.speed;
  contact.culling = case_.contact.culling;

  const double die_offset = play - half_thickness;
  const auto surface = [&](double offset, Side side) {
    const DoubleDome<double> exact({}, offset);
    // The tools are flat beyond x = 86 and y = 186 mm.
    const HeightTableGrid<R> grid{R(0), R(100), R(0), R(200), R(case_.contact.table_spacing),
                                  true, true};
    return HeightSurface<HeightTable<R>>(HeightTable<R>(exact, grid), side);
  };
  const auto add = [&](auto shape, ToolMotion motion) {
    model_.add(std::make_unique<RigidToolContact<NativePack<R>, decltype(shape)>>(
        std::move(shape), std::move(motion), contact, mesh_.node_count));
  };
  // Closed, both flange planes coincide; the punch starts with its top level with the die's flange.
  const double closed = -die_offset, open = closed - DoubleDomeParameters<double>{}.depth;
  add(surface(half_thickness, Side::above),
      ToolMotion::prescribed([=, p = punch_](double t) { return open + p(t); },
                             [p = punch_](double t) { return p.speed(t); }));
  add(surface(die_offset, Side::below),
      ToolMotion::prescribed([=](double) { return closed; }, [](double) { return 0.0; }));

  const StadiumRing<R> ring({}, R(half_thickness));
  const StadiumRing<double> plan;
  double held_area = 0;
  const std::vector<double> area = mesh_.tributary_areas();
  for (int n = 0; n < mesh_.node_count; ++n) {
    const Vec3<double> X = mesh_.nodes.get(n);
    if (plan.gap(Vec3<double>{X.x, X.y, 0}).gap <= 1e-9) held_area += area[n];
  }
  const double quarter_mass = case_.process.holder_mass / 4;
  const double ramp = case_.process.holder_ramp * punch_.duration;
  const double rate = 2 * case_.process.holder_damping_ratio *
                      std::sqrt(case_.contact.penalty * held_area / quarter_mass);
  add(ring,
      ToolMotion::free_under([=, F = case_.process.holder_force / 4](
                                 double t) { return ramp > 0 ? F * std::min(t / ramp, 1.0) : F; },
                             quarter_mass, rate, -half_thickness));
}

template class QuarterModel<double>;
template class QuarterModel<float>;

}  // namespace crossbeam::drape
