# Shows that the repository's own checks can fail: writes a small healthy tree, sees every check
# accept it, then breaks it in one way at a time and sees the check reject it for that reason.
#   cmake -DSCRIPTS=<repository>/cmake -DSCRATCH=<folder> -P cmake/mutations.cmake
cmake_minimum_required(VERSION 3.24)

set(tree "${SCRATCH}/mutations")

function(write_healthy_tree)
  file(REMOVE_RECURSE "${tree}")
  file(WRITE "${tree}/include/crossbeam/crossbeam.hpp" "#include \"crossbeam/cell/cell.hpp\"\n")
  file(WRITE "${tree}/include/crossbeam/base/version.hpp"
    "#define CROSSBEAM_VERSION_MAJOR 0\n"
    "#define CROSSBEAM_VERSION_MINOR 1\n"
    "#define CROSSBEAM_VERSION_PATCH 0\n")
  file(WRITE "${tree}/include/crossbeam/base/linalg.hpp" "#include <Eigen/Core>\n")
  file(WRITE "${tree}/include/crossbeam/cell/cell.hpp"
    "#include \"crossbeam/base/linalg.hpp\"\n#include <cmath>\n/// Energy, [C-1].\n")
  file(WRITE "${tree}/include/crossbeam/adapters/adapter.hpp" "#include <library/library.h>\n")
  file(WRITE "${tree}/docs/examples/point.cpp"
    "// [begin:law]\nint x = 1;\n// [end:law]\n")
  file(WRITE "${tree}/docs/examples/point.output" "x 1\ny 2\n")
  file(WRITE "${tree}/README.md"
    "<!-- snippet: docs/examples/point.cpp law -->\n```cpp\nint x = 1;\n```\n"
    "<!-- output: docs/examples/point.output -->\n```\nx 1\ny 2\n```\n")
  file(WRITE "${tree}/verify/README.md" "| ID | Statement |\n| --- | --- |\n| V-CELL-01 | text |\n")
  file(WRITE "${tree}/verify/cell/cell_verify.cpp" "TEST_CASE(\"V-CELL-01 text\") {}\n")
  file(WRITE "${tree}/docs/theory/cell.md" "# Cell\n\n**[C-1]** Energy (V-CELL-01).\n")
  file(WRITE "${tree}/eigen/Eigen/Core" "")
  foreach(file IN ITEMS .clang-format .clang-tidy)
    file(COPY_FILE "${SCRIPTS}/../${file}" "${tree}/${file}")
  endforeach()
  file(WRITE "${tree}/CITATION.cff" "title: x\nversion: 0.1.0\n")
  file(WRITE "${tree}/CHANGELOG.md" "# Changelog\n\n## [0.1.0] - today\n\n## [0.0.9] - before\n")
  write_tags()
endfunction()

# docs/tags.md as the tree has to have it; whatever else the check finds is not asked for here.
function(write_tags)
  execute_process(
    COMMAND "${CMAKE_COMMAND}" "-DROOT=${tree}" -DWRITE_TAGS=ON -P "${SCRIPTS}/check_claims.cmake"
    OUTPUT_QUIET ERROR_QUIET)
endfunction()

function(run_check script)
  execute_process(
    COMMAND "${CMAKE_COMMAND}" "-DROOT=${tree}" "-DEIGEN=${tree}/eigen"
      -P "${SCRIPTS}/${script}.cmake"
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  set(result "${result}" PARENT_SCOPE)
  set(output "${output}" PARENT_SCOPE)
endfunction()

# mutation(<script> <message expected> <file> <text appended>)
function(mutation script expected file)
  write_healthy_tree()
  file(APPEND "${tree}/${file}" ${ARGN})
  run_check("${script}")
  if(result EQUAL 0)
    message(FATAL_ERROR "${script} accepted ${file} with: ${ARGN}")
  endif()
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  string(FIND "${output}" "${expected}" position)
  if(position EQUAL -1)
    message(FATAL_ERROR "${script} rejected ${file} without \"${expected}\":\n${output}")
  endif()
  message(STATUS "${script} fails as it must: ${expected}")
endfunction()

write_healthy_tree()
set(skipped "")
foreach(script IN ITEMS layering check_claims check_version check_format check_tidy)
  run_check("${script}")
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${script} rejected the healthy tree:\n${output}")
  endif()
  if(output MATCHES "skipped")
    list(APPEND skipped "${script}")
  endif()
endforeach()

if(NOT check_format IN_LIST skipped)
  mutation(check_format "would change" include/crossbeam/cell/cell.hpp "int  two_spaces;\n")
endif()
if(NOT check_tidy IN_LIST skipped)
  mutation(check_tidy "invalid case style for class 'wrong_case'" include/crossbeam/cell/cell.hpp
    "class wrong_case {};\n")
endif()

mutation(layering "against the direction of the layers" include/crossbeam/base/linalg.hpp
  "#include \"crossbeam/cell/cell.hpp\"\n")
mutation(layering "against the direction of the layers" include/crossbeam/crossbeam.hpp
  "#include \"crossbeam/adapters/adapter.hpp\"\n")
mutation(layering "beside it in the same layer" include/crossbeam/cell/cell.hpp
  "#include \"crossbeam/kinematics/kinematics.hpp\"\n")
mutation(layering "the umbrella is for users only" include/crossbeam/cell/cell.hpp
  "#include \"crossbeam/crossbeam.hpp\"\n")
mutation(layering "detail of another folder" include/crossbeam/cell/cell.hpp
  "#include \"crossbeam/base/detail/secret.hpp\"\n")
mutation(layering "third party outside adapters" include/crossbeam/cell/cell.hpp
  "#include <fmt/core.h>\n")
mutation(layering "is not one of the layers" include/crossbeam/extra/extra.hpp "\n")

write_healthy_tree()
foreach(script IN ITEMS check_snippets check_links)
  run_check("${script}")
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${script} rejected the healthy tree:\n${output}")
  endif()
endforeach()

mutation(check_claims "V-CELL-02 stands in verify/README.md, but in no test name"
  verify/README.md "| V-CELL-02 | text |\n")
mutation(check_claims "V-CELL-02 stands in verify/README.md, but on no page of docs/theory"
  verify/README.md "| V-CELL-02 | text |\n")
mutation(check_claims "V-CELL-01 has more than one row" verify/README.md "| V-CELL-01 | text |\n")
mutation(check_claims "V-CELL-02 stands in a test name, but not in verify/README.md"
  verify/cell/cell_verify.cpp "TEST_CASE(\n    \"V-CELL-02 text\") {}\n")
mutation(check_claims "V-CELL-02 stands on a page of docs/theory, but not in verify/README.md"
  docs/theory/cell.md "See V-CELL-02.\n")
mutation(check_claims "[C-2] is cited in include, but not defined"
  include/crossbeam/cell/cell.hpp "/// [C-2]\n")
mutation(check_claims "[C-2] is defined in docs/theory, but never cited"
  docs/theory/cell.md "**[C-2]** Force.\n")
mutation(check_claims "[C-1] is defined more than once" docs/theory/cell.md "**[C-1]** Again.\n")
mutation(check_claims "docs/tags.md is not the list of the tags" docs/theory/cell.md
  "## Forces\n\n**[C-2]** Force.\n")
mutation(check_claims "docs/tags.md is not the list of the tags" docs/tags.md "| [C-9] |\n")

mutation(check_snippets "README.md: 2 C++ blocks, 1 of them" README.md "```cpp\nint y;\n```\n")
mutation(check_snippets "differs from the compiled code" docs/index.md
  "<!-- snippet: docs/examples/point.cpp law -->\n```cpp\nint x = 2;\n```\n")
mutation(check_snippets "differs from what the example prints" docs/index.md
  "<!-- output: docs/examples/point.output -->\n```\nx 1\ny 3\n```\n")
mutation(check_snippets "differs from what the example prints" docs/examples/point.output "z 3\n")
mutation(check_snippets "no file docs/examples/none.output" docs/index.md
  "<!-- output: docs/examples/none.output -->\n```\nx 1\n```\n")

mutation(check_links "no file theory/none.md" docs/index.md "See [none](theory/none.md#part).\n")

foreach(file IN ITEMS CITATION.cff CHANGELOG.md)
  write_healthy_tree()
  file(READ "${tree}/${file}" text)
  string(REPLACE "0.1.0" "0.2.0" text "${text}")
  file(WRITE "${tree}/${file}" "${text}")
  run_check(check_version)
  if(result EQUAL 0 OR NOT output MATCHES "states 0\\.2\\.0")
    message(FATAL_ERROR "check_version accepted a wrong version in ${file}:\n${output}")
  endif()
  message(STATUS "check_version fails as it must: wrong version in ${file}")
endforeach()
