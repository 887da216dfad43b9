"""The mutation run itself can fail: a toy header with one line that its test does not look at.

    mutate_test.py [C++ compiler] [doctest's include folder]
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(HERE))
import instrument  # noqa: E402
import mutate  # noqa: E402

COMPILER = "c++"
INCLUDE = []

TOY = """#pragma once
#include "crossbeam/base/scalar.hpp"
namespace crossbeam {
template <class T>
struct Spring {
  T k1, k2;
  T force(const T& u) const {
    return k1 * u - T(0.5) * k2 * u * u;
  }
  T energy(const T& u) const {
    return T(0.5) * k1 * u * u;
  }
  T never_called(const T& u) const { return k1 + u; }
};
inline double table(const double (&a)[2], int index) { return a[index] + a[0]; }
}  // namespace crossbeam
"""

TOY_TEST = """#include "crossbeam/cell/toy.hpp"
#include <doctest/doctest.h>
TEST_CASE("V-TOY-01 force") {
  const crossbeam::Spring<double> s{3, 5};
  CHECK(s.force(2.0) == -4.0);
  CHECK(s.force(7.0) == 21 - 122.5);
  CHECK(s.energy(2.0) >= 0);  // does not look
  const double a[] = {1, 7};
  CHECK(crossbeam::table(a, 1) == 8);
}
"""


def line_of(text):
    return next(k for k, line in enumerate(TOY.split("\n"), 1) if text in line)


class Instrumented(unittest.TestCase):
    """What the instrumenter touches and what it leaves alone."""

    def mutants(self, body, header="template <class T> T f(const T& a1, const T& a2, T s, T c)"):
        source = "#pragma once\nnamespace crossbeam {\n" + header + " {\n" + body + "\n}\n}\n"
        work = instrument.Instrumenter("crossbeam/cell/x.hpp", source, 0, set())
        text = work.run()
        self.assertEqual(re.sub(r"\n#include .*\n#line .*", "", text).count("\n"),
                         source.count("\n"))
        return [f"{m['before']} => {m['after']}" for m in work.mutants], text

    def test_binary_operators(self):
        found, text = self.mutants("return a1 * s - c / s;")
        for change in ("a1 * s => a1 / s", "a1 * s => a1", "s - c / s => s + c / s",
                       "s - c / s => s", "c / s => c * s", "a1 => a2"):
            self.assertIn(change, found)
        self.assertIn("- mutation::Sub{", text)

    def test_left_alone(self):
        for body in ("if (!(s > 0)) throw Error(1, 2);", "std::vector<std::array<T, 3>> v;",
                     "using std::sqrt;", "static_assert(1 + 1 == 2);", "T x[3][2] = {};",
                     "// a + b", "const T* p = &s;", "if constexpr (N < 3) g();"):
            found, _ = self.mutants(body, "template <class T> T f(T s)")
            self.assertEqual(found, [], body)

    def test_unary_index_constant_loop(self):
        found, _ = self.mutants("for (int k = 0; k < 3; ++k) s += -A(0, 1) * v[2] * T(0.5);")
        for change in ("k < 3 => k + 1 < 3", "-A(0, 1) => A(0, 1)", "v[2] => v[1]",
                       "T(0.5) => T(1.5 * 0.5)"):
            self.assertIn(change, found)

    def test_no_pointer_loses_its_guard(self):
        found, _ = self.mutants("if (!p || s < p->x) return s;")
        self.assertFalse([f for f in found if "||" in f])

    def test_twins_are_in_scope(self):
        found, _ = self.mutants("const T b1 = s; { const T b2 = b1; } return b1;")
        self.assertNotIn("b1 => b2", found)


class Judged(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        folder = pathlib.Path(cls.scratch.name)
        include = folder / "source"
        (include / "crossbeam" / "cell").mkdir(parents=True)
        shutil.copytree(HERE.parent.parent / "include" / "crossbeam" / "base",
                        include / "crossbeam" / "base")
        (include / "crossbeam" / "cell" / "toy.hpp").write_text(TOY)
        (folder / "toy_verify.cpp").write_text(TOY_TEST)
        cls.mutants = instrument.instrument(include, folder)
        program = folder / "toy"
        subprocess.run([COMPILER, "-std=c++20", "-O0", "-w", f"-I{folder}/include",
                        f"-I{HERE.parent}", *INCLUDE, str(HERE / "main.cpp"),
                        str(folder / "toy_verify.cpp"), "-o", str(program)], check=True)
        seconds, reached_by = mutate.baseline(program, folder)
        cls.results = [mutate.judge(program, m, seconds, reached_by) for m in cls.mutants]
        cls.report = mutate.summary(cls.mutants, cls.results, {}, 0.0, [])

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def survivors(self, line):
        return [s for s in self.report["survivors"] if s["line"] == line]

    def test_the_line_nobody_tests_survives(self):
        line = line_of("k1 * u * u")
        self.assertTrue(self.survivors(line))
        self.assertTrue(any(s["before"].startswith("u * u") for s in self.survivors(line)))

    def test_the_line_nobody_calls_is_not_reached(self):
        notes = {s["note"] for s in self.survivors(line_of("never_called"))}
        self.assertEqual(notes, {"not reached by any test"})

    def test_the_tested_line_is_killed(self):
        self.assertEqual(self.survivors(line_of("k1 * u - T")), [])

    def test_score(self):
        r = self.report
        self.assertEqual(r["killed"] + len(r["survivors"]) + r["not_applicable"], r["mutants"])
        self.assertLess(r["score"], mutate.AIM)
        self.assertGreater(r["killed"], 10)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        COMPILER = sys.argv[1]
    INCLUDE = [f"-I{folder}" for folder in sys.argv[2:]]
    unittest.main(argv=sys.argv[:1])
