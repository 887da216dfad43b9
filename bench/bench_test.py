"""Tests of bench.py: python3 bench_test.py"""

import sys
import unittest
from unittest import mock

sys.dont_write_bytecode = True
if sys.version_info < (3, 11):
    print("bench_test: skipped, needs Python 3.11")
    sys.exit(77)
import bench  # noqa: E402


class Bench(unittest.TestCase):
    def run_it(self, *arguments, status=0):
        """What is built and run, in order."""
        steps = []
        with mock.patch.object(bench.packages, "require"), \
                mock.patch.object(bench.build, "build",
                                  side_effect=lambda _, name: steps.append("build " + name) or 1.0), \
                mock.patch.object(bench.process, "call", side_effect=lambda words: (
                    steps.append(" ".join(str(word) for word in words)), status)[1]), \
                mock.patch.object(bench, "say"):
            got = bench.bench(list(arguments))
        self.assertEqual(got, status)
        return steps

    def test_all_programs_are_known(self):
        self.assertTrue(set(bench.FIRST) <= set(bench.programs()))

    def test_what_compiles_soonest_comes_first(self):
        self.assertEqual(bench.in_order(["bench_drape", "bench_cell", "bench_a", "bench_roofline"]),
                         ["bench_roofline", "bench_cell", "bench_a", "bench_drape"])

    def test_each_is_run_before_the_next_is_built(self):
        steps = self.run_it("--benchmark_filter=x")
        self.assertEqual(steps[0], "build bench_roofline")
        self.assertRegex(steps[1], "bench_roofline --benchmark_min_time=.* --benchmark_filter=x$")
        self.assertEqual(steps[2], "build bench_cell")
        self.assertIn("compile_time.py", steps[-2])
        self.assertIn("ratios.py", steps[-1])

    def test_a_failure_ends_it(self):
        self.assertEqual(len(self.run_it(status=1)), 2)

    def test_one_fabric(self):
        steps = self.run_it("--benchmark_filter=x", "--scene=a.toml")
        self.assertEqual(len(steps), 2)
        self.assertTrue(steps[1].endswith("bench_gauss_point --scene=a.toml --benchmark_filter=x"))


if __name__ == "__main__":
    unittest.main()
