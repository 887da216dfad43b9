#pragma once
/// @file
/// Everything but the adapters. The order is the way the data flow: parameters -> cell -> law ->
/// element -> mesh -> contact -> time step. A header includes its own folder and those before it.

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

#include "crossbeam/law/shear.hpp"
#include "crossbeam/law/woven_membrane.hpp"

#include "crossbeam/element/bending.hpp"
#include "crossbeam/element/membrane.hpp"
#include "crossbeam/element/quadrilateral.hpp"
#include "crossbeam/element/triangle.hpp"

#include "crossbeam/mesh/batches.hpp"
#include "crossbeam/mesh/levels.hpp"
#include "crossbeam/mesh/mesh.hpp"
#include "crossbeam/mesh/nodal_state.hpp"
#include "crossbeam/mesh/numbering.hpp"
#include "crossbeam/mesh/tangent_entries.hpp"

#include "crossbeam/contact/double_dome.hpp"
#include "crossbeam/contact/height_surface.hpp"
#include "crossbeam/contact/height_table.hpp"
#include "crossbeam/contact/primitives.hpp"
#include "crossbeam/contact/stadium_ring.hpp"
#include "crossbeam/contact/tool_contact.hpp"

#include "crossbeam/dynamics/bending_sweep.hpp"
#include "crossbeam/dynamics/central_difference.hpp"
#include "crossbeam/dynamics/first_order_system.hpp"
#include "crossbeam/dynamics/ledger.hpp"
#include "crossbeam/dynamics/membrane_sweep.hpp"
#include "crossbeam/dynamics/model.hpp"
#include "crossbeam/dynamics/statics.hpp"
#include "crossbeam/dynamics/step_order.hpp"
#include "crossbeam/dynamics/thread_team.hpp"
