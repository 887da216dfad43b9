#include "supplied.hpp"

#include "crossbeam/base/error.hpp"

namespace crossbeam::drape {

std::string_view supplied_text(std::string_view name) {
  for (const SuppliedFile& file : supplied_files())
    if (file.name == name) return file.text;
  throw InputError("supplied file", std::string(name), "", "the name of a file of this program");
}

References supplied_references() {
  return parse_references(supplied_text("references.toml"), "references.toml");
}

}  // namespace crossbeam::drape
