#pragma once
/// @file
/// From a scene file (TOML) to a checked DrapeCase.

#include "case.hpp"

#include "crossbeam/base/error.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace crossbeam::drape {

/// The folder of the scene files that come with the program.
[[nodiscard]] std::filesystem::path scene_folder();

/// Whether a case is one of those that come with the program: "realistic" and its like.
[[nodiscard]] bool is_supplied_case(const std::string& name);

/// The file of a case: "realistic" and its like are looked up in scene_folder(), a name that ends
/// in ".toml" is a path. Throws InputError otherwise.
[[nodiscard]] std::filesystem::path scene_path(const std::string& case_or_path);

/// Reads and checks a scene file. A field that the file leaves out keeps the default of case.hpp.
/// Throws InputError naming field, value, file, line and what is admissible.
[[nodiscard]] DrapeCase load_scene(const std::filesystem::path& file);

/// The same from text; `source` stands for the file name in messages.
[[nodiscard]] DrapeCase parse_scene(std::string_view text, const std::string& source);

/// Sets one field from text, as the command line does: set_field(c, "process.speed", "2").
/// Throws InputError, calling the field `shown_as`, for a text of the wrong type; ranges are
/// validate's business.
void set_field(DrapeCase& drape_case, const std::string& field, const std::string& text,
               const std::string& shown_as);

/// What an InputError's text says after "is not admissible: ".
[[nodiscard]] std::string admissible_part(const InputError& error);

/// The dotted names of all fields, in the order of the scene files.
[[nodiscard]] std::vector<std::string> field_names();

/// Unit and admissible range of a field for help texts: "[m/s] a number > 0 and <= 100".
[[nodiscard]] std::string field_range(const std::string& field);

/// Its unit alone; "" where it has none.
[[nodiscard]] std::string field_unit(const std::string& field);

}  // namespace crossbeam::drape
