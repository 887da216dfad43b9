#!/usr/bin/env python3
"""Turns the results of `./run bench` into a small record and prints the tables of
docs/benchmarks.md.

usage: bench/record.py out/bench/bench_*.json [--save bench/results/<cpu>-<compiler>/<date>.json]

The record keeps, for every benchmark, the median of the time per item and its coefficient of
variation over the repetitions; no host name and no paths.
"""

import argparse
import json
import os
import sys

# Title; numerator; denominator (a slower benchmark over a faster one reads as "times faster").
RATIOS = [
    ("paper in Eigen, 4x4 LU / 2x2 inverse, cell",
     "cell/forces/paper_lu_4x4/converged/double", "cell/forces/paper_inverse_2x2/converged/double"),
    ("paper in Eigen (2x2) / second-order cell, scalar",
     "cell/forces/paper_inverse_2x2/converged/double",
     "cell/forces/second_order_cell/converged/double"),
    ("paper in Eigen (2x2) / energy cell converged, scalar",
     "cell/forces/paper_inverse_2x2/converged/double", "cell/forces/energy_cell/converged/double"),
    ("paper in Eigen (2x2) / energy cell 3 sweeps, double pack",
     "cell/forces/paper_inverse_2x2/converged/double",
     "cell/forces/energy_cell/3_sweeps/pack_double"),
    ("paper in Eigen (2x2) / energy cell 3 sweeps, float pack",
     "cell/forces/paper_inverse_2x2/converged/double",
     "cell/forces/energy_cell/3_sweeps/pack_float"),
    ("paper in Eigen (LU) / Gauss point, constant shear, double pack",
     "gauss_point/forces/paper_lu_4x4/converged/double",
     "gauss_point/forces/constant_shear/3_sweeps/pack_double"),
    ("paper in Eigen (2x2) / Gauss point, constant shear, double pack",
     "gauss_point/forces/paper_inverse_2x2/converged/double",
     "gauss_point/forces/constant_shear/3_sweeps/pack_double"),
    ("paper in Eigen (2x2) / Gauss point, constant shear, float pack",
     "gauss_point/forces/paper_inverse_2x2/converged/double",
     "gauss_point/forces/constant_shear/3_sweeps/pack_float"),
    ("paper in Eigen (2x2) / corner forces, constant shear, double pack",
     "gauss_point/corner_forces/paper_inverse_2x2/converged/double",
     "gauss_point/corner_forces/constant_shear/3_sweeps/pack_double"),
    ("paper in Eigen (2x2) / corner forces, constant shear, float pack",
     "gauss_point/corner_forces/paper_inverse_2x2/converged/double",
     "gauss_point/corner_forces/constant_shear/3_sweeps/pack_float"),
    ("scalar / double pack, Gauss point, measured shear, 3 sweeps",
     "gauss_point/forces/measured_shear/3_sweeps/double",
     "gauss_point/forces/measured_shear/3_sweeps/pack_double"),
    ("double / float pack, the same",
     "gauss_point/forces/measured_shear/3_sweeps/pack_double",
     "gauss_point/forces/measured_shear/3_sweeps/pack_float"),
    ("converged / 3 sweeps, double pack",
     "gauss_point/forces/measured_shear/converged/pack_double",
     "gauss_point/forces/measured_shear/3_sweeps/pack_double"),
    ("3 sweeps / 2 sweeps, double pack",
     "gauss_point/forces/measured_shear/3_sweeps/pack_double",
     "gauss_point/forces/measured_shear/2_sweeps/pack_double"),
    ("measured / constant shear, 3 sweeps, double pack",
     "gauss_point/forces/measured_shear/3_sweeps/pack_double",
     "gauss_point/forces/constant_shear/3_sweeps/pack_double"),
    ("forces and tangent / forces, 3 sweeps, double pack",
     "gauss_point/forces_and_tangent/measured_shear/3_sweeps/pack_double",
     "gauss_point/forces/measured_shear/3_sweeps/pack_double"),
    ("autodiff / hand-written forces, 3 sweeps, double pack",
     "gauss_point/forces_autodiff/measured_shear/3_sweeps/pack_double",
     "gauss_point/forces/measured_shear/3_sweeps/pack_double"),
    ("autodiff / hand-written tangent, 3 sweeps, double pack",
     "gauss_point/forces_and_tangent_autodiff/measured_shear/3_sweeps/pack_double",
     "gauss_point/forces_and_tangent/measured_shear/3_sweeps/pack_double"),
    ("autodiff / hand-written tangent, 3 sweeps, scalar",
     "gauss_point/forces_and_tangent_autodiff/measured_shear/3_sweeps/double",
     "gauss_point/forces_and_tangent/measured_shear/3_sweeps/double"),
    ("step: scalar / double pack, 1 300 elements",
     "step/1300/full/double", "step/1300/full/pack_double"),
    ("step: double / float pack, 1 300 elements",
     "step/1300/full/pack_double", "step/1300/full/pack_float"),
    ("step: 130 000 / 1 300 elements, double pack",
     "step/130000/full/pack_double", "step/1300/full/pack_double"),
    ("step: 130 000 / 1 300 elements, float pack",
     "step/130000/full/pack_float", "step/1300/full/pack_float"),
    ("step: 1.1 million / 1 300 elements, double pack",
     "step/1102500/full/pack_double", "step/1300/full/pack_double"),
    ("step: one by one / four in flight, 1.1 million elements, double pack",
     "step/1102500/one_by_one/pack_double", "step/1102500/full/pack_double"),
    ("step: full / no bending, double pack",
     "step/1300/full/pack_double", "step/1300/no_bending/pack_double"),
    ("step: full / no bending, float pack",
     "step/1300/full/pack_float", "step/1300/no_bending/pack_float"),
    ("step: full / no bulk viscosity, double pack",
     "step/1300/full/pack_double", "step/1300/no_viscosity/pack_double"),
    ("step: full / no hourglass control, double pack",
     "step/1300/full/pack_double", "step/1300/no_hourglass/pack_double"),
    ("step: full / bare membrane, double pack",
     "step/1300/full/pack_double", "step/1300/bare/pack_double"),
    ("step: 4 points / 1 point, double pack",
     "step/1300/4_points/pack_double", "step/1300/full/pack_double"),
    ("step: double dome 5 mm with contact / sheet without, double pack",
     "step/double_dome/5_mm/pack_double", "step/1300/full/pack_double"),
    ("double dome 5 mm: double / float pack",
     "step/double_dome/5_mm/pack_double", "step/double_dome/5_mm/pack_float"),
]

NUMBERS = ["double", "pack_double", "pack_float"]

CONTEXT = ["date", "num_cpus", "mhz_per_cpu", "load_avg", "compiler", "flags", "commit",
           "pack_lanes_double", "pack_lanes_float"]


def read(files):
    """Context of the first file; {benchmark: {"ns": median, "cv": coefficient of variation}}."""
    context, results = {}, {}
    for name in files:
        if os.path.getsize(name) == 0:  # a filter that matched nothing in this program
            continue
        with open(name, encoding="utf-8") as file:
            data = json.load(file)
        context = context or {k: data["context"][k] for k in CONTEXT if k in data["context"]}
        for row in data["benchmarks"]:
            if row.get("error_occurred"):
                sys.exit(f"{row['name']}: {row['error_message']}")
            if row.get("run_type") != "aggregate":
                continue
            time = next((v for k, v in row.items() if k.startswith("time_per_")), None)
            if time is None:  # a rate of the machine, not a time per item
                continue
            entry = results.setdefault(row["run_name"], {})
            entry["repetitions"] = row["repetitions"]
            if row["aggregate_name"] == "median":
                entry["ns"] = round(1e9 * time, 3)
            elif row["aggregate_name"] == "cv":
                entry["cv"] = round(time, 4)
    return context, dict(sorted(results.items()))


def rounded(ns):
    return f"{ns:.0f}" if ns >= 100 else f"{ns:#.3g}"


def print_times(results):
    """One table per first part of the names; a row has what the next parts say, a column each
    number type."""
    tables = {}
    for name, entry in results.items():
        if name.endswith("/real_time"):  # of several threads: what they cost is no time per item
            continue
        program, *what, number = name.split("/")
        title = ", ".join(part.replace("_", " ") for part in what)
        tables.setdefault(program, {}).setdefault(title, {})[number] = entry["ns"]
    for program, rows in tables.items():
        print(f"\n### {program.replace('_', ' ').capitalize()}\n")
        print("| | scalar | pack, double | pack, float |\n| --- | ---: | ---: | ---: |")
        for title, times in rows.items():
            cells = [rounded(times[number]) if number in times else "-" for number in NUMBERS]
            print(f"| {title} | {' | '.join(cells)} |")


def main():
    parser = argparse.ArgumentParser(description="Record of a benchmark run, and its ratios.")
    parser.add_argument("files", nargs="+", help="JSON files written by ./run bench")
    parser.add_argument("--save", metavar="FILE", help="write the record there")
    parser.add_argument("--cpu", help="name of the processor, for the record")
    arguments = parser.parse_args()
    context, results = read(arguments.files)
    if arguments.cpu:
        context["cpu"] = arguments.cpu

    print("| Ratio | |\n| --- | ---: |")
    for title, above, below in RATIOS:
        if above in results and below in results:
            print(f"| {title} | {results[above]['ns'] / results[below]['ns']:.2f} |")
    print_times(results)

    if arguments.save:
        lines = ",\n".join(f"    {json.dumps(k)}: {json.dumps(v)}" for k, v in results.items())
        with open(arguments.save, "w", encoding="utf-8") as file:
            file.write(f'{{\n  "context": {json.dumps(context)},\n'
                       f'  "time_per_item": {{\n{lines}\n  }}\n}}\n')


if __name__ == "__main__":
    main()
