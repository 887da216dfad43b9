// Every header of the library but the adapters; with HOSTILE_MACROS after the macros of other
// people's headers. Compiled only.
#ifdef HOSTILE_MACROS
#include <complex.h>

#include "hostile_macros.hpp"
#endif

#include "crossbeam/crossbeam.hpp"
#include "crossbeam/verification/battery.hpp"
#include "crossbeam/verification/cell_battery.hpp"
#include "crossbeam/verification/element_battery.hpp"
#include "crossbeam/verification/evidence.hpp"
#include "crossbeam/verification/law_battery.hpp"
#include "crossbeam/verification/patch.hpp"
#include "crossbeam/verification/random.hpp"
#include "crossbeam/verification/strains.hpp"
#include "crossbeam/verification/taylor_test.hpp"

int main() {}
