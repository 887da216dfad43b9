// What check_tidy.cmake gives to clang-tidy.
#include "crossbeam/crossbeam.hpp"
