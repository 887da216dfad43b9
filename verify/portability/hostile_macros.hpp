// Macros of widespread headers whose names a library may have chosen too. A host that includes such a
// header before crossbeam compiles all the same (every_header.cpp).
#pragma once

// Where the standard library and Eigen meet such macros is not our matter: they come first.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SparseCore>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iomanip>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <ostream>
#include <random>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>
#if defined(__SSE2__)
#include <immintrin.h>
#elif defined(__ARM_NEON)
#include <arm_neon.h>
#endif

// <complex.h>: the C header defines I, and complex in C mode
#undef I
#define I not_for_crossbeam
#define complex not_for_crossbeam
#define imaginary not_for_crossbeam

// <windows.h> and what it includes
#define min(a, b) (((a) < (b)) ? (a) : (b))
#define max(a, b) (((a) > (b)) ? (a) : (b))
#define far
#define near
#define small char
#define hyper not_for_crossbeam
#define pascal not_for_crossbeam
#define cdecl not_for_crossbeam
#define interface struct
#define IN
#define OUT
#define OPTIONAL
#define ERROR 0
#define IGNORE 0
#define DELETE 0
#define STRICT 1
#define TRUE 1
#define FALSE 0
#define CONST const
#define VOID void
#define ABSOLUTE 1
#define RELATIVE 2
#define TRANSPARENT 1
#define OPAQUE 2
#define DIFFERENCE 11
#define DOMAIN 1
#define OVERFLOW 3
#define rad1 not_for_crossbeam
#define grp1 not_for_crossbeam

// <X11/Xlib.h>
#define None 0L
#define Always 2
#define Bool int
#define Status int
#define Success 0
#define True 1
#define False 0
#define Above 0
#define Below 1
#define Convex 2
#define Complex 0
#define CursorShape 0
#define Unsorted 0

// <sys/sysmacros.h>, <sys/param.h>, <termios.h>, <ctype.h> of some systems
#define major(x) not_for_crossbeam
#define minor(x) not_for_crossbeam
#define MIN(a, b) not_for_crossbeam
#define MAX(a, b) not_for_crossbeam
#define B0 0
#define _B 1
#define _C 2
#define _L 3
#define _N 4
#define _P 5
#define _S 6
#define _U 7
#define _X 8

// <AssertMacros.h> of macOS, test frameworks, logging
#define check(x) not_for_crossbeam
#define verify(x) not_for_crossbeam
#define require(x, y) not_for_crossbeam
#define CHECK(x) not_for_crossbeam
#define REQUIRE(x) not_for_crossbeam
#define VERIFY(x) not_for_crossbeam
#define ASSERT(x) not_for_crossbeam
#define EXPECTS(x) not_for_crossbeam
#define LOG(x) not_for_crossbeam

// Qt
#define signals public
#define slots
#define emit
#define foreach for
#define forever for (;;)

// Numerical codes
#define PI 3
#define EPS 1e-9
#define TOL 1e-9
#define ZERO 0
#define ONE 1
#define TWO 2
#define HALF 0.5
#define DIM 3
#define SQR(x) ((x) * (x))
#define SIGN(a, b) not_for_crossbeam
