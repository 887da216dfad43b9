# Warnings for the programs of this repository; never part of crossbeam::crossbeam.
add_library(crossbeam_warnings INTERFACE)
target_compile_options(crossbeam_warnings INTERFACE
  $<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:
    -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
    # Packs wider than the baseline registers change the calling convention, which matters only
    # between objects compiled for different processors.
    -Wno-psabi
    $<$<BOOL:${CROSSBEAM_WARNINGS_AS_ERRORS}>:-Werror>>)
