# Fails when CITATION.cff or the newest entry of CHANGELOG.md disagrees with version.hpp:
#   cmake -DROOT=<repository> -P cmake/check_version.cmake
cmake_minimum_required(VERSION 3.24)

# The first capture of `pattern` in a file; it is an error if there is none.
function(read_version result file pattern)
  file(READ "${ROOT}/${file}" text)
  if(NOT "\n${text}" MATCHES "${pattern}")
    message(FATAL_ERROR "${file} states no version")
  endif()
  set(${result} "${CMAKE_MATCH_1}" PARENT_SCOPE)
endfunction()

set(header include/crossbeam/base/version.hpp)
read_version(major ${header} "\n#define CROSSBEAM_VERSION_MAJOR ([0-9]+)\n")
read_version(minor ${header} "\n#define CROSSBEAM_VERSION_MINOR ([0-9]+)\n")
read_version(patch ${header} "\n#define CROSSBEAM_VERSION_PATCH ([0-9]+)\n")
set(version "${major}.${minor}.${patch}")

read_version(citation CITATION.cff "\nversion: \"?([0-9.]+)\"?\n")
read_version(changelog CHANGELOG.md "\n## \\[([0-9]+\\.[0-9]+\\.[0-9]+)\\]")

foreach(file IN ITEMS citation changelog)
  if(NOT ${file} STREQUAL version)
    message(FATAL_ERROR "version: ${file} states ${${file}}, ${header} states ${version}")
  endif()
endforeach()
message(STATUS "version: ${version} everywhere")
