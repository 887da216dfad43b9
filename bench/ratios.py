#!/usr/bin/env python3
"""What the benchmarks aim at, and what they reach.

usage: bench/ratios.py [--out out/bench] [FILE ...]

Reads the JSON files of all programs (by default bench_*.json and compile_time.json in the folder of
--out), merges them into bench.json, prints one line per target and writes ratios.json: a list of
{id, what, measured, target, sense, met}. Numbers are medians over the repetitions; a target whose
benchmarks are not there has measured and met null.
"""

import argparse
import glob
import json
import os
import re
import statistics
import sys

# --- The targets ----------------------------------------------------------------------------------
# One entry per target: id, what, kind, the names of its benchmarks, sense and limit. A name may be
# a regular expression and has to match as a whole; None: no benchmark yet.
#   sense "lower": at least the limit; "upper": at most the limit.
# Kinds, with TIME the time per item (or the real time of an iteration, where there are no items):
#   ratio      TIME of `above` / TIME of `below`
#   time       TIME of `above` [ns]
#   seconds    real time of one iteration of `above` [s]
#   counter    counter `counter` of `above`
#   real_ratio real time of an iteration of `above` / of `below`
#   spread     largest / smallest TIME of all that match `above`; a group in the expression is the
#              number of elements, and `range` its least and largest: both have to be there

# Strain -> cell -> stress -> nodal forces.
GAUSS_POINT = "gauss_point/corner_forces/constant_shear/followed/"
WARM_PAPER = "gauss_point/corner_forces/paper_inverse_2x2_warm/converged/double"

TARGETS = [
    {"id": "T1a", "what": "Gauss point, double pack: faster than the warm paper in Eigen (2x2)",
     "kind": "ratio", "above": WARM_PAPER, "below": GAUSS_POINT + "pack_double",
     "sense": "lower", "target": 35},
    {"id": "T1b", "what": "Gauss point, float pack: faster than the warm paper in Eigen (2x2)",
     "kind": "ratio", "above": WARM_PAPER, "below": GAUSS_POINT + "pack_float",
     "sense": "lower", "target": 70},
    {"id": "T2a", "what": "Counted flops of the corner forces, share of the multiply-add peak",
     "kind": "counter", "counter": "share_of_peak",
     "above": "gauss_point/corner_forces/measured_shear/followed/pack_double",
     "sense": "lower", "target": 0.50},
    {"id": "T2b", "what": "Counted flops of the whole step, share of the multiply-add peak",
     "kind": "counter", "counter": "share_of_peak", "above": "step/1300/full/pack_double",
     "sense": "lower", "target": 0.45},
    {"id": "T3a", "what": "Whole step with contact, double pack [ns per element]",
     "kind": "time", "above": "step/double_dome/5_mm/pack_double", "sense": "upper", "target": 10},
    {"id": "T3b", "what": "Whole step with contact, float pack [ns per element]",
     "kind": "time", "above": "step/double_dome/5_mm/pack_float", "sense": "upper", "target": 6},
    {"id": "T3c", "what": "Time per element from 1 300 to 130 000 elements, largest / smallest",
     "kind": "spread", "above": r"step/(\d+)/full/pack_double", "range": [1300, 130000],
     "sense": "upper", "target": 1.2},
    {"id": "T3d", "what": "Time per element from 1 300 to 1.1 million elements, largest / smallest",
     "kind": "spread", "above": r"step/(\d+)/full/pack_double", "range": [1300, 1100000],
     "sense": "upper", "target": 1.4},
    {"id": "T4a", "what": "Double dome, 5 mm, speed 2 m/s, axial scaling 25, double [s]",
     "kind": "seconds", "above": "step/double_dome/5_mm/axial_scaling_25/pack_double",
     "sense": "upper", "target": 0.5},
    {"id": "T4b", "what": "Double dome, 5 mm, speed 2 m/s, axial scaling 25, float [s]",
     "kind": "seconds", "above": "step/double_dome/5_mm/axial_scaling_25/pack_float",
     "sense": "upper", "target": 0.3},
    {"id": "T4c", "what": "Double dome, 2.5 mm, speed 1 m/s, axial scaling 25, double [s]",
     "kind": "seconds",
     "above": r"step/double_dome/2\.5_mm/axial_scaling_25/pack_double/repeats:1",
     "sense": "upper", "target": 8},
    {"id": "T5a", "what": "Step: full / bare membrane",
     "kind": "ratio", "above": "step/1300/full/pack_double", "below": "step/1300/bare/pack_double",
     "sense": "lower", "target": 1.5},
    {"id": "T5b", "what": "Step, full: options at run time / as compile-time policies",
     "kind": "ratio", "above": "step/1300/full/pack_double",
     "below": "step/1300/full/policies/pack_double", "sense": "upper", "target": 1.07},
    {"id": "T5b/bare", "what": "Step, bare: options at run time / as compile-time policies",
     "kind": "ratio", "above": "step/1300/bare/pack_double",
     "below": "step/1300/bare/policies/pack_double", "sense": "upper", "target": 1.07},
    {"id": "T5c", "what": "Step with contact: without / with culling (flat parts known in both)",
     "kind": "ratio", "above": "step/double_dome/10_mm/no_culling/pack_double",
     "below": "step/double_dome/10_mm/pack_double", "sense": "lower", "target": 1.25},
    {"id": "T6", "what": "Two threads, 100 000 elements or more: faster than one",
     "kind": "real_ratio", "above": "step/130000/1_threads/pack_double/real_time",
     "below": "step/130000/2_threads/pack_double/real_time", "sense": "lower", "target": 1.7},
    {"id": "T7", "what": "Unstructured / structured mesh",
     "kind": "ratio", "above": "step/20000/unstructured/pack_double",
     "below": "step/20000/full/pack_double", "sense": "upper", "target": 2.2},
]

SECONDS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
NO_COUNTER = {"family_index", "per_family_instance_index", "repetitions", "repetition_index",
              "threads", "iterations"}


# --- Reading --------------------------------------------------------------------------------------
def merge(files):
    """All programs as one: the contexts by file, the rows one after the other."""
    merged = {"contexts": {}, "benchmarks": []}
    for name in files:
        if os.path.getsize(name) == 0:  # a filter that matched nothing in this program
            continue
        with open(name, encoding="utf-8") as file:
            data = json.load(file)
        program = os.path.splitext(os.path.basename(name))[0]
        # No host name, no folders.
        merged["contexts"][program] = {key: value for key, value in data["context"].items()
                                       if key not in ("host_name", "executable")}
        merged["benchmarks"] += [dict(row, program=program) for row in data["benchmarks"]]
    return merged


def medians(rows):
    """{benchmark: {number: median}}: the median that the program states, or else that of its single
    runs; times in seconds. A benchmark that failed is not there."""
    stated, single = {}, {}
    for row in rows:
        if row.get("error_occurred"):
            continue
        name = row.get("run_name", row["name"])
        unit = SECONDS[row.get("time_unit", "ns")]
        numbers = {key: value * (unit if key in ("real_time", "cpu_time") else 1)
                   for key, value in row.items()
                   if isinstance(value, (int, float)) and not isinstance(value, bool)
                   and key not in NO_COUNTER}
        if row.get("run_type") == "aggregate":
            if row["aggregate_name"] == "median":
                stated[name] = numbers
        else:
            single.setdefault(name, []).append(numbers)
    results = {name: {key: statistics.median([run[key] for run in runs if key in run])
                      for key in runs[0]} for name, runs in single.items()}
    results.update(stated)
    return results


# --- Measuring ------------------------------------------------------------------------------------
def matching(results, pattern):
    """Matches of the pattern, a name or an expression, and the numbers of each."""
    if pattern is None:
        return []
    found = ((re.fullmatch(pattern, name), numbers) for name, numbers in results.items())
    return [(match, numbers) for match, numbers in found if match]


def time_of(numbers):
    """Seconds per item, or of an iteration where there are no items."""
    per_item = [value for key, value in numbers.items() if key.startswith("time_per_")]
    return per_item[0] if per_item else numbers.get("real_time")


def single(results, pattern, value):
    """The value at the one benchmark that matches; of several the median; None if there is none."""
    values = [value(numbers) for _, numbers in matching(results, pattern)]
    values = [v for v in values if v is not None]
    return statistics.median(values) if values else None


def measure(target, results):
    """The number of a target, None where a benchmark is missing."""
    kind = target["kind"]
    if kind == "spread":
        low, high = target["range"]
        times = {}
        for match, numbers in matching(results, target["above"]):
            elements = int(match.group(1))
            if 0.9 * low <= elements <= 1.1 * high:
                times[elements] = time_of(numbers)
        # Both ends have to be there, near enough.
        if not times or min(times) > 1.1 * low or max(times) < 0.9 * high:
            return None
        return max(times.values()) / min(times.values())
    value = {"ratio": time_of, "time": time_of,
             "seconds": lambda numbers: numbers.get("real_time"),
             "real_ratio": lambda numbers: numbers.get("real_time"),
             "counter": lambda numbers: numbers.get(target.get("counter"))}[kind]
    above = single(results, target["above"], value)
    if above is None:
        return None
    if kind in ("ratio", "real_ratio"):
        below = single(results, target["below"], value)
        return above / below if below else None
    return 1e9 * above if kind == "time" else above


def judge(results, targets=None):
    """One entry of ratios.json per target."""
    entries = []
    for target in TARGETS if targets is None else targets:
        measured = measure(target, results)
        met = None
        if measured is not None:
            lower = target["sense"] == "lower"
            met = measured >= target["target"] if lower else measured <= target["target"]
        entries.append({"id": target["id"], "what": target["what"],
                        "measured": None if measured is None else float(f"{measured:.4g}"),
                        "target": target["target"], "sense": target["sense"], "met": met})
    return entries


def table(entries):
    """The entries as lines of Markdown."""
    lines = ["| Target | | measured | aim | |", "| --- | --- | ---: | ---: | --- |"]
    for entry in entries:
        measured = "-" if entry["measured"] is None else f"{entry['measured']:.3g}"
        sign = ">=" if entry["sense"] == "lower" else "<="
        word = {True: "met", False: "missed", None: "not measured"}[entry["met"]]
        lines.append(f"| {entry['id']} | {entry['what']} | {measured} | "
                     f"{sign} {entry['target']:g} | {word} |")
    return "\n".join(lines)


def main(arguments=None):
    parser = argparse.ArgumentParser(description="The benchmarks against their targets.")
    parser.add_argument("files", nargs="*", help="JSON files (default: those in the folder)")
    parser.add_argument("--out", default="out/bench", metavar="FOLDER")
    options = parser.parse_args(arguments)
    files = options.files or sorted(glob.glob(os.path.join(options.out, "bench_*.json")) +
                                    glob.glob(os.path.join(options.out, "compile_time.json")))
    if not files:
        sys.exit(f"ratios: no results in {options.out}")
    merged = merge(files)
    entries = judge(medians(merged["benchmarks"]))
    os.makedirs(options.out, exist_ok=True)
    for name, data in (("bench.json", merged), ("ratios.json", entries)):
        with open(os.path.join(options.out, name), "w", encoding="utf-8") as file:
            json.dump(data, file, indent=1)
            file.write("\n")
    print(table(entries))


if __name__ == "__main__":
    main()
