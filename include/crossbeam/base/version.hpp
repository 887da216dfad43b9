#pragma once
/// @file
/// The version of crossbeam, written here and nowhere else: CMake, the package configuration and
/// the drape's summary read it from these three lines.

#define CROSSBEAM_VERSION_MAJOR 0
#define CROSSBEAM_VERSION_MINOR 1
#define CROSSBEAM_VERSION_PATCH 0

#define CROSSBEAM_STRINGIFY_IMPL(x) #x
#define CROSSBEAM_STRINGIFY(x) CROSSBEAM_STRINGIFY_IMPL(x)

#define CROSSBEAM_VERSION                      \
  CROSSBEAM_STRINGIFY(CROSSBEAM_VERSION_MAJOR) \
  "." CROSSBEAM_STRINGIFY(CROSSBEAM_VERSION_MINOR) "." CROSSBEAM_STRINGIFY(CROSSBEAM_VERSION_PATCH)
