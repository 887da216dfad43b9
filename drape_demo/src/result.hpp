#pragma once
/// @file
/// What one drape hands to the writers: plain data, no solver types. Units: kN, mm, ms, kg.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace crossbeam::drape {

struct ShearPoint {
  double x = 0, y = 0;   ///< in the formed plan [mm]
  double shear_deg = 0;  ///< signed shear angle [deg]
};

/// One row of the energy ledger of the quarter model [kN mm = J]. `residual` is punch work + holder
/// work minus every other term.
struct LedgerRow {
  double time = 0;    ///< [ms]
  double stroke = 0;  ///< [mm]
  double punch_work = 0, holder_work = 0;
  double yarn = 0, shear = 0, bending = 0, hourglass = 0, contact = 0, kinetic = 0;
  double friction = 0, contact_damping = 0, mass_damping = 0, bulk_viscosity = 0;
  double residual = 0;
};

/// Named values on the nodes or the elements of one frame.
struct Field {
  std::string name;
  int components = 1;
  std::vector<double> values;  ///< components x count, item after item
};

struct Frame {
  double time = 0;             ///< [ms]
  double stroke = 0;           ///< [mm]
  std::vector<double> points;  ///< x y z of every node [mm]
  std::vector<Field> point_fields, cell_fields;
};

struct Cost {
  std::int64_t steps = 0, element_steps = 0;
  double cpu_s = 0;  ///< of the thread that runs it; with several threads of the process
  double wall_s = 0, ns_per_element_step = 0;
  double time_step_ms = 0;  ///< dt used
};

/// What was counted over the run; the same with any number of threads.
struct WorkCounts {
  std::int64_t steps_sampled = 0;  ///< steps with a row of the ledger
  std::int64_t gauss_points = 0;   ///< evaluated by the steps
  /// Packs of nodes that the tools asked in the steps: left alone, asked for the height of a flat
  /// part, asked for all of the surface.
  std::int64_t contact_culled = 0, contact_flat = 0, contact_general = 0;
  friend bool operator==(const WorkCounts&, const WorkCounts&) = default;
};

struct DrapeResult {
  std::vector<std::array<int, 4>> quads;  ///< node numbers, counter-clockwise, seen from above
  Frame formed;                           ///< the last frame
  std::vector<LedgerRow> ledger;
  std::vector<ShearPoint> shear_points;            ///< points 1..10
  std::vector<std::array<double, 2>> outline;      ///< formed free edges, from x = 0 to y = 0
  double maximum_shear_deg = 0;                    ///< largest element angle
  std::array<double, 2> maximum_shear_material{};  ///< where it sits on the flat blank [mm]
  double draw_in_x = 0, draw_in_y = 0;             ///< on the symmetry axes [mm]
  std::array<double, 2> corner{};                  ///< formed blank corner [mm]
  double residual_over_punch_work = 0;             ///< largest over the run, last punch work
  double slack_fraction = 0;        ///< area share whose yarn contact is open at the end [-]
  double largest_yarn_tension = 0;  ///< at the end [kN/mm]
  double kinetic_over_punch_work_at_95 = 0;  ///< at 95 % of the stroke [-]
  double kinetic_over_internal_at_end = 0;   ///< after the hold [-]
  std::int64_t cell_fallbacks =
      0;  ///< second-order cell: element-steps answered by the energy cell
  WorkCounts work{};
  Cost cost{};
};

}  // namespace crossbeam::drape
