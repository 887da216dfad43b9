#include "scene.hpp"

#include "fields.hpp"
#include "spelling.hpp"
#include "toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <locale>
#include <map>
#include <numbers>
#include <sstream>
#include <type_traits>
#include <utility>

#ifndef CROSSBEAM_SCENE_DIR
#error "define CROSSBEAM_SCENE_DIR as the string of the folder drape_demo/scene"
#endif

namespace crossbeam::drape {

std::string Range::text(bool whole) const {
  const std::string noun = whole ? "a whole number" : "a number";
  const auto number = [](double value) { return fmt::format("{}", value); };
  const bool below = std::isfinite(high);
  switch (kind) {
    case Kind::closed:
      return noun + " >= " + number(low) + (below ? " and <= " + number(high) : "");
    case Kind::low_open:
      return noun + " > " + number(low) + (below ? " and <= " + number(high) : "");
    case Kind::open: return noun + " > " + number(low) + " and < " + fmt::format("{:.6g}", high);
    case Kind::one_of_two: return number(low) + " or " + number(high);
    case Kind::finite: return noun;
  }
  return noun;
}

namespace {

/// Where a field was set, for messages: " (realistic.toml:12)", or "" when it is not known.
using Locator = std::function<std::string(const std::string& field)>;

template <class E>
std::vector<std::string> choice_names() {
  std::vector<std::string> names;
  for (const auto& named : names_of(E{})) names.emplace_back(named.name);
  return names;
}

template <class E>
bool choose(E& value, const std::string& text) {
  for (const auto& named : names_of(E{})) {
    if (text != named.name) continue;
    value = named.value;
    return true;
  }
  return false;
}

/// The parts of an InputError's text: "<field> = <value> is not admissible: <admissible>".
/// @{
constexpr std::string_view separator = " is not admissible: ";
std::string value_part(const InputError& error) {
  const std::string what = error.what();
  const std::size_t begin = error.field().size() + std::string_view(" = ").size();
  return what.substr(begin, what.find(separator, begin) - begin);
}
/// @}

std::string hint(const std::string& wrong, const std::vector<std::string>& names) {
  const std::string nearest = nearest_name(wrong, names);
  return nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?";
}

// -------------------------------------------------------------------------------------------------
// Ranges of single fields

class RangeCheck {
 public:
  explicit RangeCheck(const Locator& where) : where_(where) {}

  void enter(const char* name) { path_.enter(name); }
  void leave() { path_.leave(); }
  template <class T>
  void real(const char* name, const T& value, const char* unit, const Range& range) {
    if (!std::isfinite(value) || !range.contains(value))
      refuse(path_.name(name), fmt::format("{}", value), unit, range.text());
  }
  template <class T>
  void integer(const char* name, const T& value, const char* unit, const Range& range) {
    if (!range.contains(static_cast<double>(value)))
      refuse(path_.name(name), std::to_string(value), unit, range.text(true));
  }
  template <class E>
  void choice(const char*, const E&) {}
  void flag(const char*, const bool&) {}
  void text(const char* name, const std::string& value) {
    if (printable(value, true) != value)
      refuse(path_.name(name), printable(value), "", "a text without control characters");
  }
  void list(const char* name, const std::vector<double>& values, const char* unit) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!std::isfinite(values[i]))
        refuse(fmt::format("{}[{}]", path_.name(name), i), fmt::format("{}", values[i]), unit,
               "a finite number", path_.name(name));
  }

 private:
  [[noreturn]] void refuse(const std::string& field, const std::string& value,
                           const std::string& unit, const std::string& admissible,
                           const std::string& set_as = "") const {
    throw InputError(field, value, unit == "-" ? "" : unit,
                     admissible + where_(set_as.empty() ? field : set_as));
  }

  const Locator& where_;
  FieldPath path_;
};

// -------------------------------------------------------------------------------------------------
// Rules that join several fields

/// The name becomes that of a folder.
void check_name(const std::string& name, const Locator& where) {
  constexpr std::size_t longest = 100;
  const auto letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  };
  const bool fits = std::all_of(name.begin(), name.end(), [&](char c) {
    return letter(c) || std::string_view(" -_.,+()=").find(c) != std::string_view::npos;
  });
  if (name.empty() || (fits && letter(name.front()) && name.size() <= longest)) return;
  throw InputError("name", printable(name), "",
                   fmt::format("letters, digits, spaces and -_.,+()= of ASCII, first a letter or a "
                               "digit, at most {}: the results' folder gets this name",
                               longest) +
                       where("name"));
}

/// The first place that is known.
std::string first_known(const std::vector<std::string>& places) {
  for (const auto& place : places)
    if (!place.empty()) return place;
  return "";
}

/// What the laws themselves refuse in the precision of the run, under the names of the scene and
/// with the place in the file.
template <class R>
void check_laws(const FabricInput& fabric, const Locator& where) {
  /// @param fields whose place may be the one to tell, the likeliest first
  const auto located = [&where](const std::vector<std::string>& fields, const auto& build) {
    try {
      build();
    } catch (const InputError& error) {
      // The library calls this table "shear"; that of the cell was told its name.
      std::string name = error.field();
      const std::string table = "shear.", in_scene = "fabric.shear.";
      for (std::size_t at = 0; (at = name.find(table, at)) != std::string::npos;
           at += in_scene.size())
        name.insert(at, "fabric.");
      std::vector<std::string> places{where(name)};
      for (const auto& field : fields)
        if (name.find(field) != std::string::npos) places.push_back(where(field));
      for (const auto& field : fields) places.push_back(where(field));
      throw InputError(InputError(name, value_part(error), "", admissible_part(error)),
                       first_known(places));
    }
  };
  const auto real = [](const std::vector<double>& list) {
    return std::vector<R>(list.begin(), list.end());
  };
  located({"fabric.cell", "integration.precision"},
          [&] { crossbeam::validate(fabric.cell.cast<R>(), "fabric.cell"); });
  const ShearInput& shear = fabric.shear;
  const std::string kind = "fabric.shear.kind", precision = "integration.precision";
  if (shear.kind == ShearLawKind::constant)
    located({"fabric.shear.modulus", precision},
            [&] { static_cast<void>(ConstantShear<R>(R(shear.modulus), shear.measure)); });
  if (shear.kind == ShearLawKind::polynomial)
    located({"fabric.shear.coefficients", kind, precision},
            [&] { static_cast<void>(PolynomialCurve<R>(real(shear.coefficients))); });
  if (shear.kind == ShearLawKind::tabulated) {
    located({"fabric.shear.angle", "fabric.shear.traction", kind, precision},
            [&] { static_cast<void>(TabulatedCurve<R>(real(shear.angle), real(shear.traction))); });
    // The law would take it; a fabric cannot.
    if (!(shear.angle.back() < std::numbers::pi / 2))
      throw InputError(fmt::format("fabric.shear.angle[{}]", shear.angle.size() - 1),
                       fmt::format("{}", shear.angle.back()), "rad",
                       "a number < pi/2" + where("fabric.shear.angle"));
  }
}

void check_case(const DrapeCase& c, const Locator& where) {
  RangeCheck ranges(where);
  visit_fields(c, ranges);
  check_name(c.name, where);
  if (c.integration.precision == Precision::float_)
    check_laws<float>(c.fabric, where);
  else
    check_laws<double>(c.fabric, where);

  const double smaller = std::min(c.blank.half_width, c.blank.half_length);
  if (c.blank.element_size > smaller / 2)
    throw InputError(
        "blank.element_size", fmt::format("{}", c.blank.element_size), "mm",
        fmt::format("at most half of the smaller of half_width and half_length, {}", smaller / 2) +
            first_known({where("blank.element_size"), where("blank.half_width"),
                         where("blank.half_length")}));
  if (c.blank.perturbation > c.blank.element_size / 10)
    throw InputError("blank.perturbation", fmt::format("{}", c.blank.perturbation), "mm",
                     fmt::format("at most a tenth of element_size, {}", c.blank.element_size / 10) +
                         first_known({where("blank.perturbation"), where("blank.element_size")}));
}

// -------------------------------------------------------------------------------------------------
// TOML -> DrapeCase

class TomlReader {
 public:
  TomlReader(const toml::table& root, std::string source) : source_(std::move(source)) {
    levels_.push_back({&root, {}});
  }

  void enter(const char* name) {
    const toml::node* node = take(name);
    const toml::table* table = nullptr;
    if (node != nullptr) {
      table = node->as_table();
      if (table == nullptr)
        refuse(path_.name(name), *node, "", "a table, [" + path_.name(name) + "]");
    }
    path_.enter(name);
    levels_.push_back({table, {}});
  }

  void leave() {
    refuse_unknown_keys();
    levels_.pop_back();
    path_.leave();
  }

  template <class T>
  void real(const char* name, T& value, const char* unit, const Range& range) {
    const toml::node* node = take(name);
    if (node == nullptr) return;
    if (!node->is_number()) refuse(path_.name(name), *node, unit, range.text());
    value = T(number(*node));
  }

  template <class T>
  void integer(const char* name, T& value, const char* unit, const Range& range) {
    const toml::node* node = take(name);
    if (node == nullptr) return;
    if (!node->is_integer() || !std::in_range<T>(*node->value<std::int64_t>()))
      refuse(path_.name(name), *node, unit, range.text(true));
    value = static_cast<T>(*node->value<std::int64_t>());
  }

  template <class E>
  void choice(const char* name, E& value) {
    const toml::node* node = take(name);
    if (node == nullptr) return;
    const auto names = choice_names<E>();
    const std::string text = node->is_string() ? *node->value<std::string>() : "";
    if (!choose(value, text))
      refuse(path_.name(name), *node, "", alternatives(names) + hint(text, names));
  }

  void flag(const char* name, bool& value) {
    const toml::node* node = take(name);
    if (node == nullptr) return;
    if (!node->is_boolean()) refuse(path_.name(name), *node, "", "true or false");
    value = *node->value<bool>();
  }

  void text(const char* name, std::string& value) {
    const toml::node* node = take(name);
    if (node == nullptr) return;
    if (!node->is_string()) refuse(path_.name(name), *node, "", "a text in quotation marks");
    value = *node->value<std::string>();
  }

  void list(const char* name, std::vector<double>& values, const char* unit) {
    const toml::node* node = take(name);
    if (node == nullptr) return;
    const std::string admissible = "a list of numbers, [a, b, ...]";
    const toml::array* array = node->as_array();
    if (array == nullptr) refuse(path_.name(name), *node, unit, admissible);
    values.clear();
    for (const toml::node& item : *array) {
      if (!item.is_number()) refuse(path_.name(name), item, unit, admissible);
      values.push_back(number(item));
    }
  }

  /// To be called after the visit: the root has no leave() of its own.
  void finish() const { refuse_unknown_keys(); }

  /// Where the fields were set.
  [[nodiscard]] Locator locator() const {
    return [source = source_, lines = lines_](const std::string& field) {
      const auto line = lines.find(field);
      return line == lines.end() ? std::string() : fmt::format(" ({}:{})", source, line->second);
    };
  }

 private:
  struct Level {
    const toml::table* table;        ///< null when the file leaves the table out
    std::vector<std::string> known;  ///< the keys asked for
  };

  const toml::node* take(const char* name) {
    Level& level = levels_.back();
    level.known.emplace_back(name);
    const toml::node* node = level.table == nullptr ? nullptr : level.table->get(name);
    if (node != nullptr) lines_[path_.name(name)] = node->source().begin.line;
    return node;
  }

  /// toml++ has no double for a whole number beyond 2^53; the nearest one will do.
  static double number(const toml::node& node) {
    if (const auto* whole = node.as_integer()) return static_cast<double>(whole->get());
    return node.as_floating_point()->get();
  }

  [[nodiscard]] std::string at(const toml::node& node) const {
    return fmt::format(" ({}:{})", source_, node.source().begin.line);
  }

  [[noreturn]] void refuse(const std::string& field, const toml::node& node,
                           const std::string& unit, const std::string& admissible) const {
    std::ostringstream value;
    // Not by toml++, whose layout of a list of small numbers casts negative ones to unsigned.
    if (node.is_table())
      value << "{...}";
    else if (const auto* array = node.as_array())
      value << fmt::format("[{} values]", array->size());
    else
      node.visit([&value](const auto& typed) { value << typed; });
    throw InputError(printable(field), printable(value.str()), unit == "-" ? "" : unit,
                     printable(admissible) + at(node));
  }

  void refuse_unknown_keys() const {
    const Level& level = levels_.back();
    if (level.table == nullptr) return;
    for (const auto& [key, node] : *level.table) {
      const std::string name(key.str());
      if (std::find(level.known.begin(), level.known.end(), name) != level.known.end()) continue;
      const std::string table = path_.name("");
      refuse(path_.name(name), node, "",
             fmt::format(
                 "no such key{}; the keys {} are {}", hint(name, level.known),
                 table.empty() ? "of a scene" : "of [" + table.substr(0, table.size() - 1) + "]",
                 fmt::join(level.known, ", ")));
    }
  }

  std::string source_;
  FieldPath path_;
  std::vector<Level> levels_;
  std::map<std::string, toml::source_index> lines_;
};

// -------------------------------------------------------------------------------------------------
// Text -> one field

class FieldSetter {
 public:
  FieldSetter(const std::string& field, const std::string& text, const std::string& shown_as)
      : field_(field), text_(text), shown_as_(shown_as) {}

  void enter(const char* name) { path_.enter(name); }
  void leave() { path_.leave(); }
  template <class T>
  void real(const char* name, T& value, const char* unit, const Range& range) {
    if (wanted(name) && !parse(value)) refuse(unit, range.text());
  }
  template <class T>
  void integer(const char* name, T& value, const char* unit, const Range& range) {
    if (wanted(name) && !parse(value)) refuse(unit, range.text(true));
  }
  template <class E>
  void choice(const char* name, E& value) {
    if (!wanted(name)) return;
    const auto names = choice_names<E>();
    if (!choose(value, text_)) refuse("", alternatives(names) + hint(text_, names));
  }
  void flag(const char* name, bool& value) {
    if (!wanted(name)) return;
    if (text_ != "true" && text_ != "false") refuse("", "true or false");
    value = text_ == "true";
  }
  void text(const char* name, std::string& value) {
    if (wanted(name)) value = text_;
  }
  void list(const char* name, std::vector<double>& values, const char* unit) {
    if (!wanted(name)) return;
    double value = 0;
    if (!parse(value)) refuse(unit, "a number");
    values.assign(1, value);
  }

  [[nodiscard]] bool found() const { return found_; }

 private:
  bool wanted(const char* name) {
    const bool here = path_.name(name) == field_;
    found_ = found_ || here;
    return here;
  }
  template <class T>
  bool parse(T& value) const {
#if !defined(__cpp_lib_to_chars)  // libc++ before its version 20 has from_chars of integers only
    if constexpr (std::is_floating_point_v<T>) {
      std::istringstream text(text_);
      text.imbue(std::locale::classic());
      return !text_.starts_with('+') && text >> std::noskipws >> value && text.peek() == EOF;
    } else
#endif
    {
      const char* end = text_.data() + text_.size();
      const auto [stop, error] = std::from_chars(text_.data(), end, value);
      return error == std::errc{} && stop == end;
    }
  }
  [[noreturn]] void refuse(const std::string& unit, const std::string& admissible) const {
    throw InputError(shown_as_, text_, unit == "-" ? "" : unit, admissible);
  }

  const std::string &field_, &text_, &shown_as_;
  FieldPath path_;
  bool found_ = false;
};

/// Collects name, unit and range of every field.
class FieldList {
 public:
  struct Entry {
    std::string name, unit, range;
  };

  void enter(const char* name) { path_.enter(name); }
  void leave() { path_.leave(); }
  template <class T>
  void real(const char* name, const T&, const char* unit, const Range& range) {
    add(name, unit, range.text());
  }
  template <class T>
  void integer(const char* name, const T&, const char* unit, const Range& range) {
    add(name, unit, range.text(true));
  }
  template <class E>
  void choice(const char* name, const E&) {
    add(name, "", alternatives(choice_names<E>()));
  }
  void flag(const char* name, const bool&) { add(name, "", "true or false"); }
  void text(const char* name, const std::string&) { add(name, "", "any text"); }
  void list(const char* name, const std::vector<double>&, const char* unit) {
    add(name, unit, "a list of numbers");
  }

  std::vector<Entry> entries;

 private:
  void add(const char* name, const char* unit, const std::string& range) {
    entries.push_back({path_.name(name), unit, range});
  }
  FieldPath path_;
};

std::vector<FieldList::Entry> all_fields() {
  const DrapeCase any{};
  FieldList list;
  visit_fields(any, list);
  return list.entries;
}

const std::vector<std::string>& supplied_cases() {
  static const std::vector<std::string> names{"realistic", "paper", "paper-literal"};
  return names;
}

}  // namespace

void validate(const DrapeCase& drape_case) {
  check_case(drape_case, [](const std::string&) { return std::string(); });
}

std::filesystem::path scene_folder() { return CROSSBEAM_SCENE_DIR; }

bool is_supplied_case(const std::string& name) {
  const auto& names = supplied_cases();
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::filesystem::path scene_path(const std::string& case_or_path) {
  const auto& names = supplied_cases();
  if (is_supplied_case(case_or_path)) return scene_folder() / (case_or_path + ".toml");
  const std::filesystem::path path(case_or_path);
  if (path.extension() != ".toml")
    throw InputError(
        "--case", case_or_path, "",
        alternatives(names) + ", or the path of a scene file, *.toml" + hint(case_or_path, names));
  if (!std::filesystem::is_regular_file(path))
    throw InputError("--case", case_or_path, "", "the path of an existing scene file");
  return path;
}

DrapeCase load_scene(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw InputError("scene file", file.string(), "", "a file that exists and can be read");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  return parse_scene(text, file.string());
}

namespace {

[[noreturn]] void refuse_text(const std::string& source, std::size_t line, const std::string& why) {
  throw InputError("scene file", fmt::format("{}:{}", source, line), "",
                   "valid TOML (" + why + ")");
}

/// TOML has no control characters but the tab and ends of line; toml++ 3.3 does not refuse all of
/// the others.
void refuse_control_characters(std::string_view text, const std::string& source) {
  std::size_t line = 1;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c == '\n') ++line;
    const bool end_of_line = c == '\n' || (c == '\r' && i + 1 < text.size() && text[i + 1] == '\n');
    if ((c < 0x20 && c != '\t' && !end_of_line) || c == 0x7f)
      refuse_text(source, line, fmt::format("there is a control character, {:#04x}", c));
  }
}

/// Whether toml++ meets something unexpected in the text.
bool is_unexpected(std::string_view text) {
  try {
    static_cast<void>(toml::parse(text));
  } catch (const toml::parse_error&) {
  } catch (const UnexpectedText&) {
    return true;
  }
  return false;
}

/// The first line with which the text is unexpected: the parser reads on from there no further.
std::size_t unexpected_line(std::string_view text) {
  std::vector<std::size_t> ends;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') ends.push_back(i + 1);
  ends.push_back(text.size());
  const auto first = std::partition_point(ends.begin(), ends.end(), [&](std::size_t end) {
    return !is_unexpected(text.substr(0, end));
  });
  return static_cast<std::size_t>(first - ends.begin()) + 1;
}

toml::table parsed(std::string_view text, const std::string& source) {
  refuse_control_characters(text, source);
  try {
    return toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    refuse_text(source, error.source().begin.line,
                fmt::format("{}, column {}", error.description(), error.source().begin.column));
  } catch (const UnexpectedText&) {
    refuse_text(source, unexpected_line(text), "a value, a comma or a bracket too many or too few");
  }
}

}  // namespace

DrapeCase parse_scene(std::string_view text, const std::string& source) {
  const toml::table root = parsed(text, source);
  DrapeCase drape_case;
  TomlReader reader(root, source);
  visit_fields(drape_case, reader);
  reader.finish();
  const Locator where = reader.locator();
  const std::string sweeps = where("fabric.cell_sweeps");
  if (!sweeps.empty() && drape_case.fabric.cell_solve != CellSolve::sweeps)
    throw InputError("fabric.cell_sweeps", std::to_string(drape_case.fabric.cell_sweeps), "",
                     "a number of sweeps beside fabric.cell_solve = \"sweeps\"; heights that are "
                     "followed from step to step, before this version cell_sweeps = 0, are "
                     "fabric.cell_solve = \"follow\"" +
                         sweeps);
  check_case(drape_case, where);
  return drape_case;
}

void set_field(DrapeCase& drape_case, const std::string& field, const std::string& text,
               const std::string& shown_as) {
  FieldSetter setter(field, text, shown_as);
  visit_fields(drape_case, setter);
  CROSSBEAM_EXPECTS(setter.found());
}

std::string admissible_part(const InputError& error) {
  const std::string what = error.what();
  return what.substr(what.find(separator, error.field().size()) + separator.size());
}

std::vector<std::string> field_names() {
  std::vector<std::string> names;
  for (const auto& entry : all_fields()) names.push_back(entry.name);
  return names;
}

std::string field_range(const std::string& field) {
  const std::string unit = field_unit(field);
  for (const auto& entry : all_fields())
    if (entry.name == field) return (unit.empty() ? "" : "[" + unit + "] ") + entry.range;
  return "";
}

std::string field_unit(const std::string& field) {
  for (const auto& entry : all_fields())
    if (entry.name == field) return entry.unit == "-" ? "" : entry.unit;
  return "";
}

}  // namespace crossbeam::drape
