#!/usr/bin/env python3
"""Times the kernels: `./run bench [arguments]`. Each program is built and run before the next one is
built, the quickest to compile first, so that the first numbers come soon.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from setup import ROOT, build, main, packages, process, say  # noqa: E402

# In the order of what they cost to compile; others come after them.
FIRST = ["bench_roofline", "bench_cell", "bench_element", "bench_gauss_point", "bench_step"]
TIMING = ["--benchmark_min_time=0.05", "--benchmark_repetitions=9",
          "--benchmark_enable_random_interleaving=true",
          "--benchmark_report_aggregates_only=true"]
PROGRAMS = ROOT / "build" / "bench" / "bench"


def in_order(names):
    """The programs, cheapest first."""
    return sorted(names, key=lambda name: (FIRST.index(name) if name in FIRST else len(FIRST), name))


def programs():
    return in_order(source.stem for source in (ROOT / "bench").glob("bench_*.cpp"))


def one_fabric(arguments):
    """bench --scene=FILE: the Gauss point of that fabric alone."""
    build.build("bench", "bench_gauss_point")
    scene = [word for word in arguments if word.startswith("--scene=")]
    return process.call([PROGRAMS / "bench_gauss_point", *scene,
                         *(word for word in arguments if word not in scene)])


def commit():
    return (process.output(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"]) or "unknown").strip()


def bench(arguments):
    packages.require("bench")
    if any(word.startswith("--scene=") for word in arguments):
        return one_fabric(arguments)
    out = ROOT / "out" / "bench"
    out.mkdir(parents=True, exist_ok=True)
    for name in programs():
        seconds = build.build("bench", name)
        say(f"{name}, built in {seconds:.0f} s")
        status = process.call([PROGRAMS / name, *TIMING, f"--benchmark_context=commit={commit()}",
                               "--benchmark_out_format=json",
                               f"--benchmark_out={out / name}.json", *arguments])
        if status:
            return status
    scripts = ROOT / "bench"
    return (process.call([sys.executable, scripts / "compile_time.py",
                          "--out", out / "compile_time.json"])
            or process.call([sys.executable, scripts / "ratios.py", "--out", out]))


if __name__ == "__main__":
    main(bench, sys.argv[2:])
