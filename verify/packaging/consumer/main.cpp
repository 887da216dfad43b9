#include <crossbeam/crossbeam.hpp>

#include <cstdio>
#include <cstring>

const char* version_in_second_file();
double modulus_checked_in_second_file(double value);

int main() {
  if (std::strcmp(CROSSBEAM_VERSION, EXPECTED) != 0 ||
      std::strcmp(version_in_second_file(), EXPECTED) != 0) {
    std::printf("version %s, expected %s\n", CROSSBEAM_VERSION, EXPECTED);
    return 1;
  }
  // An error thrown in one file is caught in the other: both see one class.
  try {
    modulus_checked_in_second_file(-1);
  } catch (const crossbeam::InputError& error) {
    std::printf("%s\n", error.what());
    return modulus_checked_in_second_file(2) == 2 ? 0 : 1;
  }
  std::printf("a negative modulus was accepted\n");
  return 1;
}
