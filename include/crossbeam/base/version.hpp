#pragma once
/// @file
/// The version of crossbeam, written here and nowhere else: CMake, the package configuration and
/// the drape's summary read it from these three lines. And what every header needs: C++20.

#if (defined(_MSVC_LANG) ? _MSVC_LANG : __cplusplus) < 202002L
#error "crossbeam needs C++20: compile with -std=c++20 (MSVC: /std:c++20, CMake: cxx_std_20)"
#endif

#define CROSSBEAM_VERSION_MAJOR 0
#define CROSSBEAM_VERSION_MINOR 1
#define CROSSBEAM_VERSION_PATCH 0

#define CROSSBEAM_STRINGIFY_IMPL(x) #x
#define CROSSBEAM_STRINGIFY(x) CROSSBEAM_STRINGIFY_IMPL(x)

#define CROSSBEAM_VERSION                      \
  CROSSBEAM_STRINGIFY(CROSSBEAM_VERSION_MAJOR) \
  "." CROSSBEAM_STRINGIFY(CROSSBEAM_VERSION_MINOR) "." CROSSBEAM_STRINGIFY(CROSSBEAM_VERSION_PATCH)
