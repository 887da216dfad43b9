#pragma once
/// @file
/// What a contact can say about a start before the run: nodes that begin inside the tool, and
/// elements that a tool can pass without touching a node. Theory: docs/theory/contact.md.

#include "crossbeam/base/error.hpp"

#include <string>

namespace crossbeam {

/// Nodes that begin inside a tool.
struct StartPenetration {
  int nodes = 0;     ///< how many
  int deepest = -1;  ///< the deepest of them, or -1
  double depth = 0;  ///< of the deepest [mm]
  double speed = 0;  ///< at which its penalty throws it off if nothing holds it [mm/ms]
};

/// A penalty may throw a node off [F-7] at up to 10 mm/ms: five times the speed of a forming tool in the
/// drape, and with the usual penalty and areal mass a depth of 0.06 mm, well above the
/// rounding of coordinates and the error of a tabulated tool. A larger one lets fly what should
/// begin at rest.
inline constexpr double most_start_speed = 10;

/// @throws InputError for a penetration that throws nodes off faster than that
inline void require_gentle(const StartPenetration& start) {
  if (start.speed <= most_start_speed) return;
  throw InputError(
      "tool: depth of nodes[" + std::to_string(start.deepest) + "] at the start",
      detail::to_text(start.depth), "mm",
      "one from which the penalty throws a node off at no more than " +
          detail::to_text(most_start_speed) + " mm/ms; this one gives " +
          detail::to_text(start.speed) + " mm/ms, and " + std::to_string(start.nodes) +
          " nodes begin inside the tool. Start it further away, or set contact.check_start = false "
          "where other forces hold the fabric there");
}

/// Tag [F-8].
/// @param width the tool's, as smallest_width (tools/surface.hpp)
/// @param widest_element longest distance between two nodes of one element [mm]
/// @throws InputError for a tool that fits between the nodes of an element
inline void require_no_gap(double width, double widest_element) {
  if (!(width < widest_element)) return;
  throw InputError("tool: width", detail::to_text(width), "mm",
                   "at least the widest element, " + detail::to_text(widest_element) +
                       " mm: contact is felt at nodes alone, and this tool passes between them. "
                       "Refine the mesh, or set contact.check_start = false where the tool meets "
                       "finer elements only");
}

}  // namespace crossbeam
