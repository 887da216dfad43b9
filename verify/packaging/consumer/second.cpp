#include <crossbeam/crossbeam.hpp>

const char* version_in_second_file() { return CROSSBEAM_VERSION; }

double modulus_checked_in_second_file(double value) {
  return crossbeam::require_positive("modulus", value, "kN/mm^2");
}
