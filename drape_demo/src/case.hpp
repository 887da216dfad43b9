#pragma once
/// @file
/// Everything that defines one double-dome run, with units and defaults. The scene files in
/// drape_demo/scene set these fields by the same names; the command line overrides a few.
/// Units: kN, mm, ms, kg (so velocities are in m/s and energies in J = kN mm).

#include "crossbeam/cell/parameters.hpp"
#include "crossbeam/contact/rigid_tool_contact.hpp"
#include "crossbeam/law/shear.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace crossbeam::drape {

enum class CellFormulation { energy, second_order };  ///< E-U, or Eq. 24-25 as printed
enum class ShearLawKind { constant, polynomial, tabulated };
enum class Precision { double_, float_ };
/// How the energy cell finds its heights at every point and step: one residual evaluation from
/// those of the step before, Newton sweeps until converged, or a fixed number of them.
enum class CellSolve { follow, converge, sweeps };

struct ShearInput {
  ShearLawKind kind = ShearLawKind::polynomial;
  double modulus = 0.001;                       ///< constant: G12 of Eq. 26 [kN/mm]
  ShearMeasure measure = ShearMeasure::tensor;  ///< constant: S12 = G E12, or G 2 E12
  /// polynomial: G(|g|) = sum c_k |g|^k, g in rad [kN/mm]; by default law A of Twintex
  std::vector<double> coefficients{0.051e-3, -0.83e-3, 6.1275e-3, -12.0972e-3, 8.48e-3};
  std::vector<double> angle;     ///< tabulated: shear angles, from 0, increasing [rad]
  std::vector<double> traction;  ///< tabulated: shear traction at those angles, from 0 [kN/mm]
};

struct FabricInput {
  CellFormulation formulation = CellFormulation::energy;
  CellParameters<double> cell{};
  CellSolve cell_solve = CellSolve::follow;  ///< of the energy cell
  int cell_sweeps = 3;                       ///< CellSolve::sweeps: how many, 1..20
  ShearInput shear{};
  double warp_bending_stiffness = 1.4e-3;  ///< D1 [kN mm]; 0 switches bending off
  double weft_bending_stiffness = 1.4e-3;  ///< D2 [kN mm]
  double areal_mass = 0.743e-6;            ///< [kg/mm^2]
  double thickness = 1.0;                  ///< contact thickness [mm]
};

struct BlankInput {
  double half_width = 135;            ///< along x [mm]
  double half_length = 235;           ///< along y [mm]
  double element_size = 5;            ///< edge aimed at [mm]
  double layout = 0;                  ///< warp direction from the x axis [deg]: 0 or 45
  int gauss_points = 1;               ///< 1 or 4
  double hourglass_stiffness = 1e-4;  ///< [kN/mm]
  double perturbation = 0;            ///< amplitude of a random start perturbation [mm]
  std::uint64_t seed = 1;             ///< of that perturbation
};

struct ProcessInput {
  double stroke = 60;                 ///< [mm]
  double speed = 2;                   ///< mean punch speed V [m/s]
  double hold = 0.1;                  ///< hold after the stroke, as a share of its duration [-]
  double holder_force = 0.1;          ///< on the full part [kN]
  double holder_ramp = 0.03;          ///< share of the stroke over which the force rises [-]
  double holder_mass = 0.05;          ///< of the full ring [kg]
  double holder_damping_ratio = 0.2;  ///< of the holder on the fabric's contact stiffness [-]
};

struct ContactInput {
  double penalty = 0.05;       ///< contact pressure per penetration [kN/mm^3]
  double damping_ratio = 0.2;  ///< of a node on the penalty [-]
  double friction = 0.2;       ///< Coulomb coefficient, fabric on tool [-]
  Friction friction_model = Friction::elastic_stick;
  double viscous_slip = 0.02;  ///< viscous, smooth: full-friction slip as a share of the speed [-]
  double smoothing = 0;        ///< depth over which the penalty sets in; 0: at once [mm]
  double table_spacing = 0.5;  ///< of the tabulated tool surface [mm]
  bool culling = true;         ///< skip nodes that provably cannot touch a tool
};

struct IntegrationInput {
  double step_factor = 0.9;      ///< of the proven critical step [-]
  double axial_scaling = 1;      ///< s: yarns s times softer along, as stiff in bending; >= 1 [-]
  double mass_damping = 0.02;    ///< [1/ms]
  double bulk_viscosity = 0.06;  ///< linear, on the fibre stretch rates [-]
  Precision precision = Precision::double_;
  int threads = 1;                       ///< that share a step; the result is the same in every bit
  std::int64_t step_limit = 10'000'000;  ///< a run of more steps is refused
};

struct OutputInput {
  int frames = 20;           ///< .vtu frames, from the start to the end
  int ledger_samples = 200;  ///< ledger rows over the run
};

struct DrapeCase {
  std::string name;
  std::string description;
  std::string preset;  ///< of the command line; empty without (presets.hpp)
  FabricInput fabric{};
  BlankInput blank{};
  ProcessInput process{};
  ContactInput contact{};
  IntegrationInput integration{};
  OutputInput output{};
};

/// Throws InputError for the first field that is out of its range.
void validate(const DrapeCase& drape_case);

}  // namespace crossbeam::drape
