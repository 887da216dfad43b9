#pragma once
/// @file
/// Everything but the adapters and what only implicit methods and statics need, which who asks for
/// it includes: model/first_order_system.hpp, model/statics.hpp, sweep/membrane_tangent.hpp. The
/// order is the way the data flow: parameters -> cell -> law -> element -> mesh -> model -> sweep,
/// contact -> time step. A header includes its own folder and those before it.

#include "crossbeam/base/counting.hpp"
#include "crossbeam/base/dual.hpp"
#include "crossbeam/base/error.hpp"
#include "crossbeam/base/linalg.hpp"
#include "crossbeam/base/scalar.hpp"
#include "crossbeam/base/simd.hpp"
#include "crossbeam/base/version.hpp"

#include "crossbeam/kinematics/convected.hpp"
#include "crossbeam/kinematics/fibre_frame.hpp"

#include "crossbeam/cell/crossed_beam.hpp"
#include "crossbeam/cell/parameters.hpp"
#include "crossbeam/cell/second_order.hpp"
#include "crossbeam/cell/yarn.hpp"

#include "crossbeam/tools/height_surface.hpp"
#include "crossbeam/tools/height_table.hpp"
#include "crossbeam/tools/primitives.hpp"
#include "crossbeam/tools/stadium_ring.hpp"
#include "crossbeam/tools/surface.hpp"

#include "crossbeam/law/fabric.hpp"
#include "crossbeam/law/membrane_law.hpp"
#include "crossbeam/law/shear.hpp"
#include "crossbeam/law/woven_membrane.hpp"

#include "crossbeam/element/bending.hpp"
#include "crossbeam/element/coefficients.hpp"
#include "crossbeam/element/frequency.hpp"
#include "crossbeam/element/membrane.hpp"
#include "crossbeam/element/quadrilateral.hpp"
#include "crossbeam/element/triangle.hpp"

#include "crossbeam/mesh/arrays.hpp"
#include "crossbeam/mesh/levels.hpp"
#include "crossbeam/mesh/mesh.hpp"
#include "crossbeam/mesh/numbering.hpp"

#include "crossbeam/model/force_block.hpp"
#include "crossbeam/model/ledger.hpp"
#include "crossbeam/model/model.hpp"
#include "crossbeam/model/nodal_state.hpp"
#include "crossbeam/model/tangent_entries.hpp"
#include "crossbeam/model/tool_contact.hpp"
#include "crossbeam/model/tool_motion.hpp"

#include "crossbeam/sweep/bending_sweep.hpp"
#include "crossbeam/sweep/index_batches.hpp"
#include "crossbeam/sweep/lane_array.hpp"
#include "crossbeam/sweep/membrane_constants.hpp"
#include "crossbeam/sweep/membrane_memory.hpp"
#include "crossbeam/sweep/membrane_points.hpp"
#include "crossbeam/sweep/membrane_queries.hpp"
#include "crossbeam/sweep/membrane_sweep.hpp"
#include "crossbeam/sweep/point_rows.hpp"
#include "crossbeam/sweep/run_vectors.hpp"

#include "crossbeam/contact/contact_law.hpp"
#include "crossbeam/contact/rigid_tool_contact.hpp"

#include "crossbeam/dynamics/central_difference.hpp"
#include "crossbeam/dynamics/step_order.hpp"
#include "crossbeam/dynamics/thread_team.hpp"

#include "crossbeam/simulation/fabric_model.hpp"
