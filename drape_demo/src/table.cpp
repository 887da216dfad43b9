#include "table.hpp"

#include "fields.hpp"
#include "ledger_terms.hpp"

#include "crossbeam/base/version.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace crossbeam::drape {
namespace {

constexpr double newton_millimetre = 1000;  ///< of one kN mm
constexpr int width = 98;

std::string rule(const std::string& title) {
  return fmt::format("-- {} {:-<{}}\n", title, "", width - 4 - static_cast<int>(title.size()));
}

std::string head(const DrapeCase& c, const DrapeResult& result) {
  return fmt::format(
      "crossbeam {}, case {}: fibres {}, {} elements of {:g} mm, {} point{} each, {}\n"
      "{:g} mm at {:g} m/s, friction {:g}, holder {:g} N, shear {}, bending {}, cell {}\n",
      CROSSBEAM_VERSION, c.name.empty() ? "without a name" : c.name,
      c.blank.layout == 0 ? "0/90" : "+-45 deg", result.quads.size(), c.blank.element_size,
      c.blank.gauss_points, c.blank.gauss_points == 1 ? "" : "s", name_of(c.integration.precision),
      c.process.stroke, c.process.speed, c.contact.friction, 1000 * c.process.holder_force,
      name_of(c.fabric.shear.kind),
      c.fabric.warp_bending_stiffness > 0 || c.fabric.weft_bending_stiffness > 0 ? "on" : "off",
      name_of(c.fabric.formulation));
}

/// The result beside the references, one line per quantity.
class Comparison {
 public:
  /// @param judged mark values outside the study's bands
  explicit Comparison(bool judged) : judged_(judged) {
    text_ = fmt::format("{:<12}{:>9}{:>9}{:>12}  {:>8}{:>15}{:>14}\n", "", "x [mm]", "y [mm]",
                        "this run", "net", "study", "second code");
  }

  void line(const std::string& name, const std::string& place, double value, int digits,
            const std::string& net, const Banded* study, const std::string& second,
            const std::string& unit) {
    const bool off =
        judged_ && study != nullptr && std::abs(value - study->value) > study->band * (1 + 1e-9);
    marked_ = marked_ || off;
    const std::string banded =
        study == nullptr ? "" : fmt::format("{:.{}f} +- {:.{}f}", study->value, 1, study->band, 1);
    add(name, place, fmt::format("{:.{}f}", value, digits), off, net, banded, second, unit);
  }

  void bounded(const std::string& name, const std::string& place, double value, double bound,
               const std::string& net, const std::string& unit) {
    const bool off = judged_ && std::abs(value) > bound;
    marked_ = marked_ || off;
    add(name, place, fmt::format("{:.2f}", value), off, net, fmt::format("below {:g}", bound), "",
        unit);
  }

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] bool marked() const { return marked_; }

 private:
  void add(const std::string& name, const std::string& place, const std::string& value, bool off,
           const std::string& net, const std::string& study, const std::string& second,
           const std::string& unit) {
    text_ += fmt::format("{:<12}{:>18}{:>12}{} {:>8}{:>15}{:>14}  {}\n", name, place, value,
                         off ? "*" : " ", net, study, second, unit);
  }

  std::string text_;
  bool judged_, marked_ = false;
};

std::string place(double x, double y) { return fmt::format("{:9.1f}{:9.1f}", x, y); }

std::string comparison(const DrapeCase& c, const DrapeResult& result, const References& r) {
  // The references are of fibres along the sides.
  const bool aligned = c.blank.layout == 0;
  const bool same_case = aligned && c.name == "realistic";
  Comparison table(same_case);
  const auto net = [&](double value) { return aligned ? fmt::format("{:.1f}", value) : ""; };
  const auto study = [&](const Banded& value) { return aligned ? &value : nullptr; };
  const auto second = [&](double value) { return aligned ? fmt::format("{:.2f}", value) : ""; };

  for (std::size_t i = 0; i < result.shear_points.size(); ++i) {
    const auto& p = result.shear_points[i];
    const std::string name = fmt::format("point {:>2}", i + 1), at = place(p.x, p.y);
    const std::string from_net =
        i < r.net.shear_deg.size() ? net(r.net.shear_deg[i]) : std::string();
    if (i < r.study.shear_deg.size() && i < r.second_code.shear_deg.size())
      table.line(name, at, p.shear_deg, 2, from_net, study(r.study.shear_deg[i]),
                 second(r.second_code.shear_deg[i]), "deg");
    else if (aligned)
      table.bounded(name, at, p.shear_deg, r.study.slack_flange_shear_deg, from_net, "deg");
    else
      table.line(name, at, p.shear_deg, 2, "", nullptr, "", "deg");
  }
  table.line("maximum", place(result.maximum_shear_material[0], result.maximum_shear_material[1]),
             result.maximum_shear_deg, 2, net(r.net.maximum_shear_deg),
             study(r.study.maximum_shear_deg), "", "deg (flat x, y)");
  table.line("draw-in x", "", result.draw_in_x, 2, net(r.net.draw_in_x), study(r.study.draw_in_x),
             second(r.second_code.draw_in_x), "mm");
  table.line("draw-in y", "", result.draw_in_y, 2, net(r.net.draw_in_y), study(r.study.draw_in_y),
             second(r.second_code.draw_in_y), "mm");
  table.line("corner x", "", result.corner[0], 2, "", study(r.study.corner[0]),
             second(r.second_code.corner[0]), "mm");
  table.line("corner y", "", result.corner[1], 2, "", study(r.study.corner[1]),
             second(r.second_code.corner[1]), "mm");
  const Banded energy{newton_millimetre * r.study.shear_energy.value,
                      newton_millimetre * r.study.shear_energy.band};
  const double shear = result.ledger.empty() ? 0 : result.ledger.back().shear;
  table.line("shear energy", "", newton_millimetre * shear, 2, "", study(energy), "",
             "N mm (quarter)");

  std::string text = rule("shear angles and shape") + table.text();
  if (aligned)
    text += fmt::format("net: kinematics only; study and second code ({}): case realistic\n{}",
                        r.second_code.name, table.marked() ? "* outside the study's band\n" : "");
  else
    text += "the references are of 0/90 fibres and not shown\n";
  return text;
}

std::string ledger(const DrapeResult& result) {
  const LedgerRow last = result.ledger.empty() ? LedgerRow{} : result.ledger.back();
  std::array<std::vector<std::string>, 3> columns;
  const auto cell = [&last](const char* label, double value) {
    const double share = last.punch_work != 0 ? 100 * value / last.punch_work : 0;
    return fmt::format("{:<15}{:>9.2f}{:>8.3f}", label, newton_millimetre * value, share);
  };
  const auto heading = [](const char* label) {
    return fmt::format("{:<15}{:>9}{:>8}", label, "N mm", "%");
  };
  columns[0].push_back(heading("supplied"));
  columns[1].push_back(heading("stored"));
  columns[2].push_back(heading("dissipated"));
  for (const auto& term : ledger_terms)
    columns[static_cast<std::size_t>(term.kind)].push_back(cell(term.label, last.*term.value));
  columns[0].push_back(cell("residual", last.residual));

  std::string text = rule("energy of the quarter at the end, shares of the punch work");
  std::size_t rows = 0;
  for (const auto& column : columns) rows = std::max(rows, column.size());
  for (std::size_t i = 0; i < rows; ++i) {
    std::string line;
    for (const auto& column : columns)
      line += fmt::format("{:<33}", i < column.size() ? column[i] : std::string());
    text += line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
  }
  text += fmt::format(
      "largest residual {:.1e} of the punch work; kinetic energy {:.2g} % of the punch work at 95 "
      "% "
      "stroke,\n{:.1e} of the internal energy at the end\n",
      result.residual_over_punch_work, 100 * result.kinetic_over_punch_work_at_95,
      result.kinetic_over_internal_at_end);
  return text;
}

std::string cost(const DrapeResult& result) {
  std::string text = rule("fabric and cost");
  text += fmt::format("slack yarns on {:.1f} % of the area, largest yarn tension {:.2f} N/mm",
                      100 * result.slack_fraction, newton_millimetre * result.largest_yarn_tension);
  if (result.cell_fallbacks > 0)
    text += fmt::format(
        "\nsecond-order cell answered by the energy cell in {} element-steps "
        "({:.2g} %)",
        result.cell_fallbacks,
        100.0 * static_cast<double>(result.cell_fallbacks) /
            static_cast<double>(std::max<std::int64_t>(1, result.cost.element_steps)));
  text += fmt::format(
      "\n{} steps of {:.4g} us, {:.4g} million element-steps, "
      "{:.1f} ns per element-step,\n{:.2f} s CPU, {:.2f} s wall\n",
      result.cost.steps, 1000 * result.cost.time_step_ms,
      1e-6 * static_cast<double>(result.cost.element_steps), result.cost.ns_per_element_step,
      result.cost.cpu_s, result.cost.wall_s);
  return text;
}

}  // namespace

std::string result_table(const DrapeCase& drape_case, const DrapeResult& result,
                         const References& references) {
  return head(drape_case, result) + comparison(drape_case, result, references) + ledger(result) +
         cost(result);
}

}  // namespace crossbeam::drape
