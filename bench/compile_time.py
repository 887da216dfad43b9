#!/usr/bin/env python3
"""What the library costs a user's compiler.

usage: bench/compile_time.py [--out out/bench/compile_time.json] [--compiler g++]
                             [--include DIR ...] [--repetitions 3]

Compiles a file that includes Eigen's core alone, one that includes all of crossbeam, and one that
uses a law, a membrane sweep and the central-difference step, all with -O3, by turns. Prints the
medians of wall time [s], processor time [s] and peak memory [MiB] of the compiler, and the ratio of
the processor time to that of Eigen's core, which a busy machine changes less than the times; writes
them as rows like those of Google Benchmark.
"""

import argparse
import datetime
import json
import os
import pathlib
import resource
import shlex
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent

YARDSTICK = "eigen_core"
SOURCES = {
    YARDSTICK: """
#include <Eigen/Core>
""",
    "umbrella": """
#include "crossbeam/crossbeam.hpp"
""",
    "one_law_one_step": """
#include "crossbeam/base/simd.hpp"
#include "crossbeam/dynamics/central_difference.hpp"
#include "crossbeam/sweep/membrane_sweep.hpp"

#include <memory>
#include <utility>

using T = crossbeam::NativePack<double>;
using Law = crossbeam::WovenMembrane<crossbeam::CrossedBeamCell<double>,
                                     crossbeam::PolynomialShear<double>>;

void run(const crossbeam::Mesh<4>& mesh, const Law& law, crossbeam::NodalState<double> state) {
  crossbeam::Model<double> model(std::move(state));
  model.add(std::make_unique<crossbeam::MembraneSweep<T, crossbeam::Quadrilateral<1>, Law>>(
      mesh, law, 1e-6, crossbeam::MembraneOptions{}));
  crossbeam::CentralDifference<T> integrator(std::move(model), crossbeam::TimeStep::fraction(1));
  integrator.step();
}
""",
}


def eigen_folders():
    """Where Eigen's headers are: what pkg-config says, or the usual places."""
    if shutil.which("pkg-config"):
        flags = subprocess.run(["pkg-config", "--cflags-only-I", "eigen3"],
                               capture_output=True, text=True, check=False)
        if flags.returncode == 0 and flags.stdout.strip():
            return [part[2:] for part in shlex.split(flags.stdout) if part.startswith("-I")]
    return [folder for folder in ("/usr/include/eigen3", "/usr/local/include/eigen3",
                                  "/opt/homebrew/include/eigen3") if os.path.isdir(folder)]


def compiled(command):
    """Wall time [s], processor time [s] and peak memory [bytes] of one compilation, which runs in a
    child of its own: the peak of children is that of the largest so far."""
    reader, writer = os.pipe()
    begin = time.monotonic()
    child = os.fork()
    if child == 0:
        status = 1
        try:
            status = subprocess.run(command, check=False).returncode
            usage = resource.getrusage(resource.RUSAGE_CHILDREN)
            unit = 1 if sys.platform == "darwin" else 1024
            os.write(writer, json.dumps([usage.ru_utime + usage.ru_stime,
                                         usage.ru_maxrss * unit]).encode())
        finally:
            os._exit(1 if status else 0)
    os.close(writer)
    with os.fdopen(reader) as pipe:
        answer = pipe.read()
    _, status = os.waitpid(child, 0)
    if status != 0:
        sys.exit(f"compile_time: failed: {shlex.join(command)}")
    cpu, memory = json.loads(answer)
    return time.monotonic() - begin, cpu, memory


def row(name, repetitions, runs, yardstick):
    """The median of the runs as an aggregate of Google Benchmark; the ratio is of medians."""
    wall, cpu, memory = (statistics.median(column) for column in zip(*runs))
    of_yardstick = statistics.median(run[1] for run in yardstick)
    return {"name": f"compile_time/{name}_median", "run_name": f"compile_time/{name}",
            "run_type": "aggregate", "aggregate_name": "median", "aggregate_unit": "time",
            "repetitions": repetitions, "iterations": repetitions, "threads": 1,
            "real_time": wall, "cpu_time": cpu, "time_unit": "s", "peak_memory_bytes": memory,
            "ratio_to_eigen_core": cpu / of_yardstick}


def main():
    parser = argparse.ArgumentParser(description="Compile time and memory of crossbeam.")
    parser.add_argument("--out", default=str(ROOT / "out/bench/compile_time.json"), metavar="FILE")
    parser.add_argument("--compiler", default=os.environ.get("CXX", "c++"))
    parser.add_argument("--include", action="append", default=[], metavar="DIR",
                        help="where Eigen is, if it is not found")
    parser.add_argument("--repetitions", type=int, default=3)
    arguments = parser.parse_args()
    folders = arguments.include or eigen_folders()
    flags = ["-std=c++20", "-O3", "-DNDEBUG"]
    command = shlex.split(arguments.compiler) + flags + [f"-I{ROOT / 'include'}"]
    for folder in folders:
        command += ["-isystem", folder]

    version = subprocess.run(shlex.split(arguments.compiler) + ["--version"],
                             capture_output=True, text=True, check=True).stdout.splitlines()[0]
    rows = []
    with tempfile.TemporaryDirectory() as scratch:
        runs = {name: [] for name in SOURCES}
        for name, text in SOURCES.items():
            (pathlib.Path(scratch) / f"{name}.cpp").write_text(text, encoding="utf-8")
        for _ in range(arguments.repetitions):  # by turns: all meet the same load of the machine
            for name in SOURCES:
                source = pathlib.Path(scratch) / f"{name}.cpp"
                runs[name].append(compiled(command + ["-c", str(source), "-o", os.devnull]))
        for name in SOURCES:
            rows.append(row(name, arguments.repetitions, runs[name], runs[YARDSTICK]))
            print(f"{rows[-1]['run_name']:32} {rows[-1]['real_time']:7.2f} s, "
                  f"processor {rows[-1]['cpu_time']:6.2f} s, "
                  f"{rows[-1]['peak_memory_bytes'] / 2**20:7.0f} MiB, "
                  f"{rows[-1]['ratio_to_eigen_core']:5.2f} of Eigen's core")

    out = pathlib.Path(arguments.out)
    out.parent.mkdir(parents=True, exist_ok=True)
    context = {"date": datetime.datetime.now().astimezone().isoformat(timespec="seconds"),
               "compiler": version, "flags": " ".join(flags), "num_cpus": os.cpu_count()}
    out.write_text(json.dumps({"context": context, "benchmarks": rows}, indent=1) + "\n",
                   encoding="utf-8")


if __name__ == "__main__":
    main()
