"""The mutation run itself can fail: a toy header with one line that its test does not look at.

    mutate_test.py [C++ compiler] [doctest's include folder]
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(HERE))
import instrument  # noqa: E402
import mutate  # noqa: E402
import record  # noqa: E402

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
inline int last_positive(const int* values, int count) {
  int found = -1;
  for (int i = 0; i < count; ++i)
    if (i < count && values[i] > 0) found = i;
  return found;
}
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
  const int values[] = {-1, 3, 4, -2};
  CHECK(crossbeam::last_positive(values, 4) == 2);
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
                     "// a + b", "const T* p = &s;", "if constexpr (N < 3) return s;"):
            found, _ = self.mutants(body, "template <class T> T f(T s)")
            self.assertEqual(found, [], body)

    def test_unary_index_constant_loop(self):
        found, _ = self.mutants("for (int k = 0; k < 3; ++k) s += -A(0, 1) * v[2] * T(0.5);")
        for change in ("s += -A(0, 1) * v[2] * T(0.5) => s -= -A(0, 1) * v[2] * T(0.5)",
                       "k < 3 => k + 1 < 3", "-A(0, 1) => A(0, 1)", "v[2] => v[1]",
                       "T(0.5) => T(1.5 * 0.5)"):
            self.assertIn(change, found)

    def test_statements_that_may_be_left_out(self):
        found, text = self.mutants(
            "v.push_back(s); a.b[1] = s; ++n; if (s > c) return; g<T, 3>(c);\n"
            "const T d = s; T e(s); Vec<T> f{s, c}; int n = 1; auto& r = s; x += 1; return s;")
        dropped = [f for f in found if f.endswith(" => ")]
        self.assertEqual(dropped, ["x += 1 => ", "v.push_back(s); => ", "a.b[1] = s; => ", "++n; => ",
                                   "return; => ", "g<T, 3>(c); => "])
        self.assertIn("{ if (mutation::kept(", text)

    def test_conditions_keep_their_short_circuit(self):
        found, text = self.mutants("if (n > 0 && v[n - 1] > s) return c;")
        self.assertIn("n > 0 && v[n - 1] > s => v[n - 1] > s", found)
        self.assertIn("n > 0 && v[n - 1] > s => n > 0", found)
        self.assertIn("(mutation::True{", text)

    def test_conditions_without_an_operator(self):
        found, _ = self.mutants("if (seen(s)) g(); return b.empty() ? s : c;")
        self.assertIn("if (seen(s)) => if (!(seen(s)))", found)
        self.assertIn("b.empty() ? => !(b.empty()) ?", found)

    def test_no_pointer_loses_its_guard(self):
        found, _ = self.mutants("if (!p || s < p->x) return s;")
        self.assertFalse([f for f in found if "||" in f])

    def test_twins_of_a_class_that_has_both(self):
        found, _ = self.mutants("g(p.x, q.first);",
                                "struct P { T x, y; }; struct Q { T first; }; void f(P p, Q q)")
        self.assertIn("p.x => p.y", found)
        self.assertNotIn("q.first => q.last", found)

    def test_twins_are_in_scope(self):
        found, _ = self.mutants("const T b1 = s; { const T b2 = b1; } return b1;")
        self.assertNotIn("b1 => b2", found)
        found, _ = self.mutants("for (int j = 0; j < 3; ++j) g(j); for (int i = 0; i < 3; ++i) g(i);")
        self.assertNotIn("i => j", found)


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
        cls.mutants = instrument.instrument(include, folder, "kernels")
        program = folder / "toy"
        subprocess.run([COMPILER, "-std=c++20", "-O0", "-w", f"-I{folder}/include",
                        f"-I{HERE.parent}", *INCLUDE, str(HERE / "main.cpp"),
                        str(folder / "toy_verify.cpp"), "-o", str(program)], check=True)
        seconds, reached_by = mutate.baseline(program, folder)
        cls.results = [mutate.judge(m, seconds, reached_by) for m in cls.mutants]
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
        self.assertLess(r["score"], record.AIM)
        self.assertGreater(r["killed"], 10)


class Limited(unittest.TestCase):
    """What does not come to an end is stopped."""

    def test_threads_that_wait_for_each_other(self):
        begin = time.monotonic()
        self.assertIsNone(mutate.run_limited(["sleep", "600"], {}, 300))
        self.assertLess(time.monotonic() - begin, 60)

    def test_what_ends_in_time(self):
        self.assertEqual(mutate.run_limited(["sh", "-c", "exit 3"], dict(os.environ), 300), 3)


class Recorded(unittest.TestCase):
    """The record counts for the headers as they were, and says so."""

    HEADER = "#pragma once\n#include <cmath>\n// text\nint f() { return 1 + 2; }\n"
    NAME = "crossbeam/mesh/x.hpp"
    SURVIVOR = {"file": NAME, "text": "return 1 + 2;", "change": "1 + 2 => 1", "kind": "sign",
                "note": ""}

    def made(self, killed, survivors=(), explanations=()):
        counts = {"mutants": 100, "judged": 100, "not_applicable": 0, "killed": killed,
                  "survivors": 100 - killed}
        return record.merged({"headers": {}, "survivors": []}, {self.NAME: counts}, survivors,
                             self.now(), "2026-01-01", "abc", dict.fromkeys(explanations, "why"))

    def now(self, header=HEADER):
        return {self.NAME: record.fingerprint(header)}

    def test_current(self):
        self.assertEqual(record.complaints(self.made(99), self.now(), {}), [])

    def test_comments_and_spaces_ask_for_no_run(self):
        spaced = self.HEADER.replace("text", "other text").replace(" + ", "  +\n ").replace(
            "cmath", "vector")
        self.assertEqual(record.complaints(self.made(99), self.now(spaced), {}), [])

    def test_changed_new_and_gone(self):
        for change in (("1 + 2", "1 - 2"), ("int f", "long f")):
            found = record.complaints(self.made(99), self.now(self.HEADER.replace(*change)), {})
            self.assertEqual(len(found), 1)
            self.assertIn(f"{self.NAME}: changed since", found[0])
        found = record.complaints(self.made(99), {"crossbeam/mesh/y.hpp": "0"}, {})
        self.assertEqual([f.split(": ")[1].split()[0] for f in found], ["gone", "new"])

    def test_score_and_survivors(self):
        self.assertIn("below", record.complaints(self.made(96), self.now(), {})[0])
        made, key = self.made(99, [self.SURVIVOR]), record.key_of(self.SURVIVOR)
        self.assertIn("no reason", record.complaints(made, self.now(), {})[0])
        self.assertEqual(record.complaints(made, self.now(), {key: "why"}), [])
        self.assertIn("no survivor", record.complaints(self.made(99), self.now(), {key: "why"})[0])

    def test_merged(self):
        made = self.made(99, [self.SURVIVOR])
        other = {"mutants": 50, "judged": 10, "not_applicable": 0, "killed": 10, "survivors": 0}
        now = {self.NAME: "1", "crossbeam/mesh/y.hpp": "2"}
        both = record.merged(made, {"crossbeam/mesh/y.hpp": other}, [], now, "2026-02-02", "def", {})
        self.assertEqual(both["survivors"], [self.SURVIVOR])
        self.assertEqual(both["headers"][self.NAME]["commit"], "abc")
        self.assertEqual((both["killed"], both["judged"], both["mutants"]), (109, 110, 150))
        self.assertTrue(both["folders"]["mesh"]["sampled"])
        self.assertEqual(record.changed(both, now), {self.NAME: "changed"})
        again = record.merged(both, {self.NAME: other}, [], now, "2026-03-03", "ghi", {})
        self.assertEqual(again["survivors"], [])

    def test_every_folder_belongs_to_a_suite_or_is_left_alone(self):
        folders = {path.name for path in record.INCLUDE.joinpath("crossbeam").iterdir()
                   if path.is_dir()}
        known = set(sum(instrument.SUITES.values(), ())) | set(instrument.FOLDERS_LEFT_ALONE)
        self.assertEqual(folders - known, set())


if __name__ == "__main__":
    if len(sys.argv) > 1:
        COMPILER = sys.argv[1]
    INCLUDE = [f"-I{folder}" for folder in sys.argv[2:]]
    unittest.main(argv=sys.argv[:1])
