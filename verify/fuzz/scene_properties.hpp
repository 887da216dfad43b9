#pragma once
/// @file
/// What the reader of scene files promises for any text: an admissible case, or an InputError with
/// file and line (properties.hpp).

#include "fuzz/properties.hpp"

#include "fields.hpp"
#include "scene.hpp"

#include <cctype>
#include <string_view>

namespace fuzz {

/// Whether a text tells a line of the file.
inline bool has_place(const std::string& text, const std::string& file) {
  for (std::size_t at = text.find(file + ":"); at != std::string::npos;
       at = text.find(file + ":", at + 1))
    if (std::isdigit(static_cast<unsigned char>(text[at + file.size() + 1])) != 0) return true;
  return false;
}

/// Every field of an accepted case is admissible.
class FieldCheck {
 public:
  void enter(const char* name) { path_.enter(name); }
  void leave() { path_.leave(); }
  template <class T>
  void real(const char* name, const T& value, const char*, const crossbeam::drape::Range& range) {
    if (!(std::isfinite(value) && range.contains(value)))
      broken("an accepted field out of range:", path_.name(name), value);
  }
  template <class T>
  void integer(const char* name, const T& value, const char*,
               const crossbeam::drape::Range& range) {
    if (!range.contains(static_cast<double>(value)))
      broken("an accepted field out of range:", path_.name(name), value);
  }
  template <class E>
  void choice(const char* name, const E& value) {
    if (std::string(crossbeam::drape::name_of(value)) == "unknown")
      broken("an accepted choice without a name:", path_.name(name));
  }
  void flag(const char*, const bool&) {}
  void text(const char*, const std::string&) {}
  void list(const char* name, const std::vector<double>& values, const char*) {
    for (double value : values)
      if (!std::isfinite(value)) broken("an accepted list that is not finite:", path_.name(name));
  }

 private:
  crossbeam::drape::FieldPath path_;
};

/// The laws of a case in the precision of its run.
template <class R>
void build(const crossbeam::drape::FabricInput& fabric) {
  using namespace crossbeam;
  using crossbeam::drape::ShearLawKind;
  const auto real = [](const std::vector<double>& list) {
    return std::vector<R>(list.begin(), list.end());
  };
  static_cast<void>(CrossedBeamCell<R>(fabric.cell.cast<R>()));
  static_cast<void>(SecondOrderCell<R>(fabric.cell.cast<R>()));
  const auto& shear = fabric.shear;
  if (shear.kind == ShearLawKind::constant)
    static_cast<void>(ConstantShear<R>(R(shear.modulus), shear.measure));
  if (shear.kind == ShearLawKind::polynomial)
    static_cast<void>(PolynomialCurve<R>(real(shear.coefficients)));
  if (shear.kind == ShearLawKind::tabulated)
    static_cast<void>(TabulatedCurve<R>(real(shear.angle), real(shear.traction)));
}

/// A text is a case that can be run, every field admissible, or it is refused with its line.
inline Outcome check_scene(std::string_view text) {
  using namespace crossbeam;
  using namespace crossbeam::drape;
  const std::string file = "fuzz/scene.toml";
  DrapeCase scene;
  try {
    scene = parse_scene(text, file);
  } catch (const InputError& error) {
    if (!has_place(error.what(), file)) broken("refused without a line:", error.what());
    return Outcome::refused;
  }
  FieldCheck all;
  visit_fields(std::as_const(scene), all);
  // What the drape builds of it must not be refused any more.
  try {
    validate(scene);
    if (scene.integration.precision == Precision::float_)
      build<float>(scene.fabric);
    else
      build<double>(scene.fabric);
  } catch (const InputError& error) {
    broken("accepted, but not to be built:", error.what());
  }
  return Outcome::answered;
}

}  // namespace fuzz
