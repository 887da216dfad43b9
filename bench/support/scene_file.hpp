#pragma once
/// @file
/// A fabric and a strain history of one's own for the Gauss-point benchmark, from a scene file of
/// the drape (docs/theory/scenes.md) with one table more:
///
///   [history]
///   warp  = [0.0, 0.01]    # stretch of the warp - 1 [-]
///   weft  = [0.0, 0.01]    # of the weft
///   shear = [0.0, 0.6]     # shear angle [rad]
///
/// The points of the ring lie evenly along the straight lines between these states. Without the
/// table they are the random ones. Needs toml++ and fmt, as the drape does.

#include "support/fabric.hpp"
#include "support/ring.hpp"

#include "crossbeam/base/error.hpp"

#if defined(CROSSBEAM_BENCH_SCENES)
#include "scene.hpp"
#include "toml.hpp"
#endif

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace bench {

#if defined(CROSSBEAM_BENCH_SCENES)

namespace detail {

using crossbeam::InputError;

/// As a person would write it.
inline std::string text_of(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

/// One list of the history; every number finite and from low to high.
inline std::vector<double> history_list(const toml::table& history, const std::string& file,
                                        const char* key, const char* unit, double low,
                                        double high) {
  const std::string field = std::string("history.") + key;
  const auto place = [&](const toml::node& node) {
    return " (" + file + ":" + std::to_string(node.source().begin.line) + ")";
  };
  const std::string range = "a number >= " + text_of(low) + " and <= " + text_of(high);
  const toml::node* node = history.get(key);
  if (node == nullptr)
    throw InputError(field, "missing", unit, "a list, " + range + " each" + place(history));
  const toml::array* array = node->as_array();
  if (array == nullptr || array->empty())
    throw InputError(field, array != nullptr ? "[]" : "no list", unit,
                     "a list of 1 number or more, " + range + " each" + place(*node));
  std::vector<double> values;
  for (const toml::node& item : *array) {
    const std::string name = field + "[" + std::to_string(values.size()) + "]";
    if (!item.is_number()) throw InputError(name, "no number", unit, range + place(item));
    const double value = *item.value<double>();
    if (!(value >= low && value <= high))
      throw InputError(name, text_of(value), unit, range + place(item));
    values.push_back(value);
  }
  return values;
}

/// `ring_size` states, evenly along the lines between those of the history.
inline RingStates history_states(const toml::table& history, const std::string& file) {
  for (const auto& [key, node] : history) {
    const std::string name(key.str());
    if (name != "warp" && name != "weft" && name != "shear")
      throw InputError("history." + name, "an unknown key", "",
                       "the keys of [history] are warp, weft, shear (" + file + ":" +
                           std::to_string(node.source().begin.line) + ")");
  }
  // Yarns longer by a half are beyond all fabrics; shear as far as the laws are checked.
  const auto warp = history_list(history, file, "warp", "-", -0.5, 0.5);
  const auto weft = history_list(history, file, "weft", "-", -0.5, 0.5);
  const auto shear = history_list(history, file, "shear", "rad", -1.2, 1.2);
  for (const auto& [name, list] : {std::pair{"weft", &weft}, {"shear", &shear}})
    if (list->size() != warp.size())
      throw InputError(std::string("history.") + name, std::to_string(list->size()) + " numbers",
                       "",
                       "as many as history.warp, " + std::to_string(warp.size()) + " (" + file +
                           ":" + std::to_string(history.get(name)->source().begin.line) + ")");
  RingStates states;
  for (int k = 0; k < ring_size; ++k) {
    const double along = static_cast<double>(warp.size() - 1) * k / (ring_size - 1);
    const auto at = [&](const std::vector<double>& list) {
      const std::size_t i = std::min(static_cast<std::size_t>(along), list.size() - 1);
      const std::size_t next = std::min(i + 1, list.size() - 1);
      return list[i] + (along - static_cast<double>(i)) * (list[next] - list[i]);
    };
    states.push_back({at(warp), at(weft), at(shear)});
  }
  return states;
}

/// The text with the lines of the table [history] emptied, so that the reader of the drape sees a
/// scene of its own and the same line numbers.
inline std::string without_history(const std::string& text) {
  std::string rest;
  bool inside = false;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string line = text.substr(begin, end - begin), bare;
    for (const char c : line.substr(0, line.find('#')))
      if (c != ' ' && c != '\t' && c != '\r') bare += c;
    // A line of a list begins with a number, a comma or a closing bracket.
    if (!bare.empty() && bare[0] == '[') inside = bare == "[history]";
    rest += (inside ? "" : line) + "\n";
    begin = end + 1;
  }
  return rest;
}

}  // namespace detail

/// @throws InputError naming field, value, unit, range and place
class SceneFile {
 public:
  RingStates states = random_states();

  explicit SceneFile(const std::string& file) {
    using crossbeam::InputError;
    std::ifstream stream(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!stream.is_open() || text.empty())
      throw InputError("--scene", file, "", "a scene file (TOML) that exists and can be read");
    fabric_ = crossbeam::drape::parse_scene(detail::without_history(text), file).fabric;
    try {
      const toml::table root = toml::parse(text, file);
      if (const toml::node* history = root.get("history")) {
        if (history->as_table() == nullptr)
          throw InputError("history", "no table", "", "a table, [history] (" + file + ")");
        states = detail::history_states(*history->as_table(), file);
      }
    } catch (const toml::parse_error& error) {
      throw InputError("--scene", file + ":" + std::to_string(error.source().begin.line), "",
                       "valid TOML (" + std::string(error.description()) + ")");
    } catch (const crossbeam::drape::UnexpectedText&) {
      throw InputError("--scene", file, "", "valid TOML");
    }
    // The law again in every number that is timed, before anything is registered.
    with_law<float>([](const auto&, const std::string&) {});
    with_law<double>([](const auto&, const std::string&) {});
  }

  /// Whether the scene's cells are followed from step to step.
  [[nodiscard]] bool follows() const {
    return fabric_.cell_solve == crossbeam::drape::CellSolve::follow;
  }

  /// Calls `use(law, iterated)` with the scene's law in the numbers R.
  template <class R, class Use>
  void with_law(const Use& use) const {
    using namespace crossbeam;
    const auto parameters = fabric_.cell.template cast<R>();
    if (fabric_.formulation == drape::CellFormulation::second_order)
      with_shear<R>(SecondOrderCell<R>(parameters), SolverControl::converged(), "converged", use);
    else
      fabric_.cell_solve == drape::CellSolve::sweeps
          ? with_shear<R>(CrossedBeamCell<R>(parameters), SolverControl::fixed(fabric_.cell_sweeps),
                          std::to_string(fabric_.cell_sweeps) + "_sweeps", use)
          : with_shear<R>(CrossedBeamCell<R>(parameters), SolverControl::converged(), "converged",
                          use);
  }

 private:
  template <class R, class Cell, class Use>
  void with_shear(const Cell& cell, crossbeam::SolverControl control, const std::string& iterated,
                  const Use& use) const {
    using namespace crossbeam;
    const auto real = [](const std::vector<double>& v) {
      return std::vector<R>(v.begin(), v.end());
    };
    const drape::ShearInput& shear = fabric_.shear;
    switch (shear.kind) {
      case drape::ShearLawKind::constant:
        return use(membrane(cell, ConstantShear<R>(R(shear.modulus), shear.measure), control),
                   iterated);
      case drape::ShearLawKind::polynomial:
        return use(membrane(cell, PolynomialShear<R>(PolynomialCurve<R>(real(shear.coefficients))),
                            control),
                   iterated);
      case drape::ShearLawKind::tabulated:
        return use(
            membrane(cell,
                     TabulatedShear<R>(TabulatedCurve<R>(real(shear.angle), real(shear.traction))),
                     control),
            iterated);
    }
  }

  crossbeam::drape::FabricInput fabric_;
};

#else

/// Stands in where the reader was not built.
struct SceneFile {
  RingStates states;

  [[nodiscard]] bool follows() const { return false; }
  explicit SceneFile(const std::string& file) {
    throw crossbeam::InputError("--scene", file, "",
                                "only where the benchmarks were configured with toml++ and fmt "
                                "(Debian: libtomlplusplus-dev, libfmt-dev)");
  }
  template <class R, class Use>
  void with_law(const Use&) const {}
};

#endif

}  // namespace bench
