#include "references.hpp"

#include "toml.hpp"

#include "crossbeam/base/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

namespace crossbeam::drape {
namespace {

/// Values by dotted name, with errors that name the file and the value.
class Reader {
 public:
  Reader(const toml::table& root, std::string source) : root_(root), source_(std::move(source)) {}

  [[nodiscard]] std::string text(const std::string& name) const {
    const auto value = root_.at_path(name).value<std::string>();
    if (!value) refuse(name, "a text");
    return *value;
  }
  [[nodiscard]] double number(const std::string& name) const {
    const auto value = root_.at_path(name).value<double>();
    if (!value || !std::isfinite(*value)) refuse(name, "a finite number");
    return *value;
  }
  [[nodiscard]] std::vector<double> numbers(const std::string& name, std::size_t count = 0) const {
    const auto* array = root_.at_path(name).as_array();
    const std::string admissible =
        count > 0 ? fmt::format("a list of {} finite numbers", count) : "a list of finite numbers";
    if (array == nullptr || (count > 0 && array->size() != count)) refuse(name, admissible);
    std::vector<double> values;
    for (const auto& item : *array) {
      const auto value = item.value<double>();
      if (!value || !std::isfinite(*value)) refuse(name, admissible);
      values.push_back(*value);
    }
    return values;
  }
  [[nodiscard]] std::array<double, 2> pair(const std::string& name) const {
    const auto values = numbers(name, 2);
    return {values[0], values[1]};
  }
  [[nodiscard]] Banded banded(const std::string& name) const {
    return {number(name), number(name + "_band")};
  }
  [[nodiscard]] std::vector<std::array<double, 2>> curve(const std::string& name) const {
    const auto x = numbers(name + ".x");
    const auto y = numbers(name + ".y", x.size());
    std::vector<std::array<double, 2>> points;
    for (std::size_t i = 0; i < x.size(); ++i) points.push_back({x[i], y[i]});
    return points;
  }

 private:
  [[noreturn]] void refuse(const std::string& name, const std::string& admissible) const {
    throw InputError(name, root_.at_path(name) ? "this value" : "missing", "",
                     admissible + " in " + source_);
  }

  const toml::table& root_;
  std::string source_;
};

}  // namespace

References load_references(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw InputError("reference file", file.string(), "", "a file that exists and can be read");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  return parse_references(text, file.string());
}

References parse_references(std::string_view text, const std::string& source) {
  toml::table root;
  try {
    root = toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    throw InputError("reference file", fmt::format("{}:{}", source, error.source().begin.line), "",
                     fmt::format("a readable TOML file ({})", error.description()));
  } catch (const UnexpectedText& error) {
    throw InputError("reference file", source, "",
                     fmt::format("a readable TOML file ({})", error.what()));
  }
  const Reader read(root, source);
  References r;

  r.net.source = read.text("net.source");
  r.net.x = read.numbers("net.x", 10);
  r.net.y = read.numbers("net.y", 10);
  r.net.shear_deg = read.numbers("net.shear_deg", 10);
  r.net.maximum_shear_deg = read.number("net.maximum_shear_deg");
  r.net.draw_in_x = read.number("net.draw_in_x");
  r.net.draw_in_y = read.number("net.draw_in_y");
  r.net.long_edge = read.curve("net.long_edge");
  r.net.short_edge = read.curve("net.short_edge");

  r.study.source = read.text("study.source");
  const auto angles = read.numbers("study.shear_deg", 8);
  const auto bands = read.numbers("study.shear_band", 8);
  for (std::size_t i = 0; i < angles.size(); ++i)
    r.study.shear_deg.push_back({angles[i], bands[i]});
  r.study.slack_flange_shear_deg = read.number("study.slack_flange_shear_deg");
  r.study.maximum_shear_deg = {read.number("study.maximum_shear_deg"),
                               read.number("study.maximum_shear_band")};
  r.study.maximum_shear_material = read.pair("study.maximum_shear_material");
  r.study.draw_in_x = read.banded("study.draw_in_x");
  r.study.draw_in_y = read.banded("study.draw_in_y");
  const auto corner = read.pair("study.corner");
  const double corner_band = read.number("study.corner_band");
  r.study.corner = {Banded{corner[0], corner_band}, Banded{corner[1], corner_band}};
  r.study.shear_energy = read.banded("study.shear_energy");

  r.second_code.name = read.text("second_code.name");
  r.second_code.source = read.text("second_code.source");
  r.second_code.shear_deg = read.numbers("second_code.shear_deg", 8);
  r.second_code.draw_in_x = read.number("second_code.draw_in_x");
  r.second_code.draw_in_y = read.number("second_code.draw_in_y");
  r.second_code.corner = read.pair("second_code.corner");
  return r;
}

}  // namespace crossbeam::drape
