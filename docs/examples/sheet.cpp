// A square sheet falls over a sphere: mesh, fabric, tool, explicit dynamics and the energy ledger.

#include <crossbeam/crossbeam.hpp>

#include <cstdio>

// [begin:gravity]
/// A load of one's own: a constant acceleration [mm/ms^2] of every node's mass. It books the energy
/// that the nodes have left by falling, so that the ledger closes.
class Gravity final : public crossbeam::ForceBlock<double> {
 public:
  explicit Gravity(double acceleration) : g_(acceleration) {}
  void add_forces(crossbeam::NodalState<double>& state, double) override {
    for (int n = 0; n < state.node_count; ++n) state.f.z[n] -= state.mass[n] * g_;
  }
  void add_energy(const crossbeam::NodalState<double>& state,
                  crossbeam::EnergyLedger& ledger) const override {
    double potential = 0;
    for (int n = 0; n < state.node_count; ++n) potential += state.mass[n] * g_ * state.x.z[n];
    ledger.add("gravity", crossbeam::EnergyKind::stored, potential);
  }
  [[nodiscard]] double omega_squared() const override { return 0; }

 private:
  double g_;
};
// [end:gravity]

int main() {
  // [begin:sheet]
  using namespace crossbeam;  // kN, mm, ms, kg
  const WovenMembrane law(CrossedBeamCell<double>({}), ConstantShear(0.001));
  const Fabric fabric(law.followed(),
                      {.areal_mass = 0.743e-6, .thickness = 1, .bending = {1.4e-3, 1.4e-3}});

  FabricModel model(rectangle(100, 100, 20, 20), fabric,
                    {.symmetry = {true, true}, .mass_damping = 0.05});
  model.add_membrane<Quadrilateral<1>>({.hourglass_modulus = 1e-4, .bulk_viscosity = 0.06});
  model.add_bending();
  const double radius = 60 + fabric.thickness() / 2;
  model.add_tool(Sphere<double>({0, 0, -radius}, radius), ToolMotion::fixed());
  model.add(Gravity(9.81e-3));

  CentralDifference drape(std::move(model), TimeStep::fraction(0.9));
  drape.advance_until(50);
  const EnergyLedger ledger = drape.sampled_step();
  // [end:sheet]

  const int corner = drape.state().node_count - 1;
  std::printf("the free corner has fallen by %.0f mm, the centre by %.1f mm\n",
              -drape.state().x.z[corner], -drape.state().x.z[0]);
  std::printf(
      "the ledger closes to a millionth of gravity's work: %s\n",
      std::abs(ledger.residual()) < 1e-6 * std::abs(ledger.value("gravity")) ? "yes" : "no");
}
