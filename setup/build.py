"""Builds of CMake's presets in build/<preset>; the log is shown where one fails."""

import os
import subprocess
import time

from setup import ROOT, Failure, packages, process, say

# What CMake reads from the environment once, at the first time of a build folder.
READ_ONCE = ("CXX", "CXXFLAGS", "LDFLAGS", "CMAKE_GENERATOR", "CMAKE_PREFIX_PATH")


def logged(command, log):
    return process.call(command, cwd=ROOT, stdout=log, stderr=subprocess.STDOUT)


def fail_with(log, text):
    log.seek(0)
    lines = log.readlines()
    raise Failure("".join(lines[-60:]) + f"run: {text}; the whole log is {log.name}")


def asked_of_cmake():
    return "".join(f"{name}={os.environ.get(name, '')}\n" for name in READ_ONCE)


def compiler_of(preset):
    """The compiler that a build folder uses."""
    cache = ROOT / "build" / preset / "CMakeCache.txt"
    for line in cache.read_text(encoding="utf-8", errors="replace").splitlines():
        if line.startswith("CMAKE_CXX_COMPILER:"):
            return line.split("=", 1)[1]
    return "unknown"


def configure(preset, *options):
    """A folder of another compiler, of other flags or of another place is begun anew."""
    folder = ROOT / "build" / preset
    asked = folder / "asked_of_cmake.txt"
    command = ["cmake", "--preset", preset, *options]
    with packages.open_log(preset) as log:
        same = not asked.exists() or asked.read_text(encoding="utf-8") == asked_of_cmake()
        if not (same and logged(command, log) == 0) and logged([*command, "--fresh"], log):
            fail_with(log, f"configuring build/{preset} failed")
    asked.write_text(asked_of_cmake(), encoding="utf-8")


def build(preset, *targets):
    """Configures and builds a preset, all of it or some targets."""
    begin = time.monotonic()
    configure(preset)
    what = " ".join(targets) or f"build/{preset}"
    say(f"Building {what} with {compiler_of(preset)} (log: build/{preset}.log)")
    command = ["cmake", "--build", "--preset", preset, "--parallel", process.jobs()]
    if targets:
        command += ["--target", *targets]
    with packages.open_log(preset) as log:
        if logged(command, log):
            fail_with(log, f"building {what} failed")
    return time.monotonic() - begin
