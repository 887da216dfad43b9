#!/usr/bin/env python3
"""Tests of ratios.py on results made by hand."""

import contextlib
import io
import json
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import ratios  # noqa: E402

IDS = ["T1a", "T1b", "T2a", "T2b", "T3a", "T3b", "T3c", "T3d", "T4a", "T4b", "T4c", "T5a", "T5b",
       "T5b/bare", "T5c", "T6", "T7"]


def rows(name, time_per_item=None, real_time=1.0, unit="ns", **counters):
    """What a program writes for a benchmark: median and coefficient of variation."""
    numbers = dict(counters)
    if time_per_item is not None:
        numbers["time_per_point"] = time_per_item
    common = {"run_name": name, "run_type": "aggregate", "repetitions": 3, "threads": 1,
              "iterations": 3, "time_unit": unit}
    median = dict(common, name=f"{name}_median", aggregate_name="median", real_time=real_time,
                  cpu_time=real_time, **numbers)
    spread = dict(common, name=f"{name}_cv", aggregate_name="cv", real_time=0.01, cpu_time=0.01,
                  **{key: 0.01 for key in numbers})
    return [median, spread]


def target(kind, **more):
    return {"id": "X", "what": "x", "kind": kind, "sense": "lower", "target": 2, "above": "a",
            "below": "b", **more}


class Medians(unittest.TestCase):
    def test_the_stated_median_is_taken_in_seconds(self):
        results = ratios.medians(rows("a", 3e-9, real_time=2.0, unit="ms"))
        self.assertAlmostEqual(results["a"]["real_time"], 2e-3)
        self.assertEqual(results["a"]["time_per_point"], 3e-9)

    def test_single_runs_have_their_median_taken(self):
        runs = [{"name": "a", "run_name": "a", "run_type": "iteration", "real_time": t,
                 "cpu_time": t, "time_unit": "us", "time_per_point": t} for t in (5, 1, 3)]
        self.assertAlmostEqual(ratios.medians(runs)["a"]["real_time"], 3e-6)
        self.assertEqual(ratios.medians(runs)["a"]["time_per_point"], 3)

    def test_failed_benchmarks_are_missing(self):
        failed = [{"name": "a", "run_name": "a", "error_occurred": True, "error_message": "no"}]
        self.assertEqual(ratios.medians(failed), {})


class Measure(unittest.TestCase):
    def setUp(self):
        self.results = ratios.medians(
            rows("a", 6e-9, real_time=30, unit="ms") + rows("b", 2e-9, real_time=20, unit="ms") +
            rows("share", share_of_peak=0.4) + rows("step/1300/full", 10e-9) +
            rows("step/20000/full", 11e-9) + rows("step/130000/full", 12e-9) +
            rows("step/1100000/full", 15e-9))

    def test_ratio_is_of_times_per_item(self):
        self.assertAlmostEqual(ratios.measure(target("ratio"), self.results), 3)

    def test_real_ratio_is_of_real_times(self):
        self.assertAlmostEqual(ratios.measure(target("real_ratio"), self.results), 1.5)

    def test_time_is_in_nanoseconds_and_seconds_in_seconds(self):
        self.assertAlmostEqual(ratios.measure(target("time"), self.results), 6)
        self.assertAlmostEqual(ratios.measure(target("seconds"), self.results), 0.03)

    def test_counter(self):
        of_share = target("counter", above="share", counter="share_of_peak")
        self.assertEqual(ratios.measure(of_share, self.results), 0.4)
        self.assertIsNone(ratios.measure(dict(of_share, above="a"), self.results))

    def test_spread_needs_both_ends_of_its_range(self):
        of_steps = target("spread", above=r"step/(\d+)/full", range=[1300, 130000])
        self.assertAlmostEqual(ratios.measure(of_steps, self.results), 1.2)
        self.assertAlmostEqual(
            ratios.measure(dict(of_steps, range=[1300, 1100000]), self.results), 1.5)
        self.assertIsNone(ratios.measure(dict(of_steps, range=[1300, 9000000]), self.results))
        self.assertIsNone(ratios.measure(dict(of_steps, range=[100, 130000]), self.results))

    def test_missing_or_unnamed_benchmarks_give_none(self):
        for missing in (dict(above=None), dict(above="c"), dict(below=None), dict(below="c")):
            self.assertIsNone(ratios.measure(target("ratio", **missing), self.results))

    def test_a_name_has_to_match_as_a_whole(self):
        self.assertIsNone(ratios.measure(target("time", above="shar"), self.results))


class Judge(unittest.TestCase):
    def test_lower_and_upper_limits(self):
        results = ratios.medians(rows("a", 6e-9) + rows("b", 3e-9))
        for sense, limit, met in (("lower", 2, True), ("lower", 2.1, False), ("upper", 2, True),
                                  ("upper", 1.9, False)):
            entry = ratios.judge(results, [target("ratio", sense=sense, target=limit)])[0]
            self.assertEqual((entry["measured"], entry["met"]), (2, met))

    def test_without_results_nothing_is_measured(self):
        entries = ratios.judge({})
        self.assertEqual([entry["id"] for entry in entries], IDS)
        for entry in entries:
            self.assertIsNone(entry["measured"])
            self.assertIsNone(entry["met"])
        self.assertIn("not measured", ratios.table(entries))

    def test_the_gauss_point_is_compared_with_the_warm_yardstick(self):
        results = ratios.medians(
            rows("gauss_point/corner_forces/paper_inverse_2x2_warm/converged/double", 600e-9) +
            rows("gauss_point/corner_forces/constant_shear/followed/pack_double", 20e-9) +
            rows("gauss_point/corner_forces/constant_shear/followed/pack_float", 8e-9) +
            rows("gauss_point/corner_forces/measured_shear/followed/pack_double", 30e-9,
                 share_of_peak=0.51))
        entries = {entry["id"]: entry for entry in ratios.judge(results)}
        self.assertEqual((entries["T1a"]["measured"], entries["T1a"]["met"]), (30, False))
        self.assertEqual((entries["T1b"]["measured"], entries["T1b"]["met"]), (75, True))
        self.assertEqual((entries["T2a"]["measured"], entries["T2a"]["met"]), (0.51, True))


class Program(unittest.TestCase):
    def test_files_are_merged_and_written(self):
        with tempfile.TemporaryDirectory() as out:
            for name in ("bench_a", "bench_b", "compile_time"):
                with open(os.path.join(out, name + ".json"), "w", encoding="utf-8") as file:
                    json.dump({"context": {"host_name": "secret", "executable": "/x", "mhz": 1},
                               "benchmarks": rows(name, 1e-9)}, file)
            with open(os.path.join(out, "bench_empty.json"), "w", encoding="utf-8"):
                pass
            text = io.StringIO()
            for _ in range(2):  # its own files are not read
                with contextlib.redirect_stdout(text):
                    ratios.main(["--out", out])
            with open(os.path.join(out, "bench.json"), encoding="utf-8") as file:
                merged = json.load(file)
            with open(os.path.join(out, "ratios.json"), encoding="utf-8") as file:
                entries = json.load(file)
        self.assertEqual(set(merged["contexts"]), {"bench_a", "bench_b", "compile_time"})
        self.assertEqual(merged["contexts"]["bench_a"], {"mhz": 1})
        self.assertEqual(len(merged["benchmarks"]), 6)
        self.assertEqual(merged["benchmarks"][0]["program"], "bench_a")
        self.assertEqual([entry["id"] for entry in entries], IDS)
        self.assertEqual(set(entries[0]), {"id", "what", "measured", "target", "sense", "met"})
        self.assertIn("| T1a |", text.getvalue())

    def test_no_results_is_an_error(self):
        with tempfile.TemporaryDirectory() as out, self.assertRaises(SystemExit):
            ratios.main(["--out", out])


if __name__ == "__main__":
    unittest.main()
