// A square sheet falls over a sphere: mesh, law, tool, explicit dynamics and the energy ledger.

#include <crossbeam/crossbeam.hpp>

#include <cstdio>
#include <memory>

/// A constant force on every node's mass, as a host code would add its own loads.
template <class R>
class Gravity final : public crossbeam::ForceBlock<R> {
 public:
  explicit Gravity(double acceleration) : g_(R(acceleration)) {}
  void add_forces(crossbeam::NodalState<R>& state, double) override {
    for (int n = 0; n < state.node_count; ++n) state.f.z[n] -= state.mass[n] * g_;
  }
  void add_energy(const crossbeam::NodalState<R>&, crossbeam::InternalEnergy&) const override {}
  [[nodiscard]] double omega_squared() const override { return 0; }

 private:
  R g_;
};

int main() {
  // [begin:sheet]
  using namespace crossbeam;
  using Real = double;
  using Lanes = NativePack<Real>;  // one SIMD register of elements at a time

  const Mesh<4> mesh = rectangle(100, 100, 20, 20);  // mm; fibres along x and y
  const auto fibres = FibreAngle<Real>::right();
  const WovenMembrane law(CrossedBeamCell<Real>(CellParameters<Real>{}),
                          ConstantShear<Real>(0.001, fibres), fibres, YarnWidth::corrected,
                          SolverControl::fixed(3));

  const double areal_mass = 0.743e-6;  // kg/mm^2
  const SymmetryPlanes planes{true, true};
  CentralDifference<Lanes> drape(
      NodalState<Real>(mesh, areal_mass, symmetry_constraints(mesh, planes)), areal_mass, 0.05);
  drape.add(std::make_unique<MembraneSweep<Lanes, Quadrilateral<1>, decltype(law)>>(
      mesh, law, areal_mass, MembraneOptions{1e-4, 0.06}));
  drape.add(std::make_unique<BendingSweep<Lanes>>(mesh, BendingStiffness{1.4e-3, 1.4e-3},
                                                  areal_mass, planes));
  const Sphere<Real> sphere({0, 0, -60.5}, 60);
  drape.add(std::make_unique<RigidToolContact<Lanes, Sphere<Real>>>(
      sphere, ToolMotion::fixed(), ContactParameters{}, mesh.node_count));
  drape.add(std::make_unique<Gravity<Real>>(9.81e-3));  // mm/ms^2

  drape.start(0.9 * drape.critical_step());
  EnergyLedger ledger;
  while (drape.time() < 50) drape.step();
  drape.step(&ledger);
  // [end:sheet]

  const double fall = -drape.state().x.z[mesh.node_count - 1];
  std::printf("the free corner has fallen by %.0f mm, the centre by %.1f mm\n", fall,
              -drape.state().x.z[0]);
  // Gravity is the one force that the ledger does not know: its work is the residual.
  std::printf("stored energy is positive: %s, gravity's work is: %s\n",
              ledger.internal.stored() > 0 ? "yes" : "no", -ledger.residual() > 0 ? "yes" : "no");
}
