"""`./run verify --quick`: after an edit, what finds its errors soonest, in three minutes.

The checks of the repository, the edited headers alone, then the test files as programs of their own
(preset `quick`): only those that are out of date, nearest to the edit first, until the time is up. What
did not get its turn is named, and is still out of date at the next call, so that several calls in a row
run everything but the drape and SUNDIALS.
"""

import concurrent.futures
import json
import os
import re
import subprocess
import time
from pathlib import Path

from setup import ROOT, build, packages, process, say

LIMIT = 170.0  # s, of three minutes
BUILD = ROOT / "build" / "quick"
INCLUDE = ROOT / "include"
CHECKS = ["layering", "check_claims", "check_version", "check_snippets"]
ELSEWHERE = ("drape", "sundials")  # folders of tests that need more than the library

# Folders of tests for the headers of a folder: its own, and those of its direct users.
NEAR = {
    "base": (["unit_base"], ["kinematics", "cell", "mesh"]),
    "kinematics": (["kinematics"], ["law", "element"]),
    "cell": (["cell"], ["law"]),
    "tools": (["contact"], ["stress"]),
    "law": (["law"], ["battery", "element"]),
    "element": (["element"], ["textile"]),
    "mesh": (["mesh"], ["element", "dynamics"]),
    "model": (["model", "dynamics"], ["element", "contact"]),
    "sweep": (["sweep", "element"], ["dynamics"]),
    "contact": (["contact"], ["dynamics"]),
    "dynamics": (["dynamics"], ["stress"]),
    "simulation": (["model"], ["dynamics"]),
    "adapters": (["law"], ["element"]),
    "verification": (["battery"], ["law"]),
}


class Unit:
    """A test file, which is a program of its own in this build."""

    def __init__(self, source):
        self.source = source
        self.folder = source.parent.name
        self.name = f"unit-{self.folder}-{source.stem}"
        self.passed = BUILD / "passed" / self.name

    @property
    def program(self):
        return BUILD / "verify" / self.name

    def edited(self):
        """The files newer than the last time that it passed; None if it never did."""
        if not self.passed.exists():
            return None
        depends = (BUILD / "verify" / "CMakeFiles" / f"{self.name}.dir" / self.folder
                   / f"{self.source.name}.o.d")
        files = read_depends(depends) if depends.exists() else []
        since = self.passed.stat().st_mtime
        return {file for file in [self.source, *files]
                if not file.exists() or file.stat().st_mtime > since}


def read_depends(file):
    """The files of the repository that an object depends on, from the compiler's list."""
    text = file.read_text(encoding="utf-8", errors="replace").replace("\\\n", " ")
    words = re.split(r"(?<!\\)\s+", text.split(":", 1)[1].strip())
    paths = (Path(word.replace("\\ ", " ")) for word in words)
    return [path for path in paths if path.is_relative_to(ROOT) and BUILD not in path.parents]


def units():
    sources = sorted((*(ROOT / "verify").glob("*/*_verify.cpp"),
                      *(ROOT / "verify").glob("*/unit_*.cpp")))
    return [Unit(source) for source in sources if source.parent.name not in ELSEWHERE]


def edited_by_git():
    """Files that differ from the last commit."""
    found = set()
    for words in (["diff", "--name-only", "HEAD"], ["ls-files", "--others", "--exclude-standard"]):
        text = process.output(["git", "-C", ROOT, *words]) or ""
        found |= {ROOT / line for line in text.splitlines()}
    return found


def headers_among(files):
    return sorted(file for file in files
                  if file.is_relative_to(INCLUDE) and file.suffix == ".hpp" and file.exists())


def distance(folder, source, text, edited):
    """0: the file itself, or the test of an edited header's folder that has its name; 1: another test
    of that folder; 2: it includes the header, or tests a direct user's folder; 3: neither."""
    subject = source.stem.removesuffix("_verify").removeprefix("unit_")
    if source in edited:
        return 0
    best = 3
    for header in headers_among(edited):
        name = header.relative_to(INCLUDE).as_posix()
        own, users = NEAR.get(header.parent.name, ([], []))
        if folder in own or folder == header.parent.name:
            best = min(best, 0 if subject in header.stem else 1)
        elif folder in users or f'"{name}"' in text:
            best = min(best, 2)
    return best


def in_order(stale, edited, seconds):
    """Nearest to the edit first; among those as near, what took least the last time."""
    def key(unit):
        text = unit.source.read_text(encoding="utf-8")
        return (distance(unit.folder, unit.source, text, edited),
                seconds.get(unit.name, len(text) / 1000), unit.name)
    return sorted(stale, key=key)


# --------------------------------------------------------------------------------------------------
# The steps


def check_repository(edited):
    """Names of the checks that failed."""
    commands = {name: ["cmake", f"-DROOT={ROOT}", "-P", ROOT / "cmake" / f"{name}.cmake"]
                for name in CHECKS}
    commands["check_format"] = ["cmake", f"-DROOT={ROOT}", "-DFILES=" + ";".join(map(str, edited)),
                                "-P", ROOT / "cmake" / "check_format.cmake"]
    return [name for name, command in commands.items() if process.call(command) != 0]


def compile_alone(headers):
    """Names of the headers that do not compile alone."""
    flags = command_of_support()

    def failed(header):
        source = BUILD / "alone" / header.relative_to(INCLUDE).with_suffix(".cpp")
        source.parent.mkdir(parents=True, exist_ok=True)
        source.write_text(f'#include "{header.relative_to(INCLUDE).as_posix()}"\n', encoding="utf-8")
        return process.call([*flags, "-fsyntax-only", source]) != 0
    with concurrent.futures.ThreadPoolExecutor(process.jobs()) as pool:
        return [header.relative_to(INCLUDE).as_posix()
                for header, bad in zip(headers, pool.map(failed, headers)) if bad]


def command_of_support():
    """The compiler and its flags as in the build, without files and precompiled headers."""
    commands = json.loads((BUILD / "compile_commands.json").read_text(encoding="utf-8"))
    words = next(entry["command"] for entry in commands
                 if entry["file"].endswith("verify/support/main.cpp")).split()
    return words[:words.index("-o")]


def judge(unit, deadline):
    """passed, failed or left out, and what there is to show."""
    begin, log = time.monotonic(), BUILD / f"{unit.name}.log"
    environment = {k: v for k, v in os.environ.items() if not k.startswith("CROSSBEAM_")}
    for command in (["cmake", "--build", BUILD, "--target", unit.name],
                    [unit.program, "--test-case-exclude=*(long)*", "--no-path-filenames=1"]):
        left = deadline - time.monotonic()
        if left <= 0:
            return "left out", "", 0.0
        with open(log, "w+", encoding="utf-8", errors="replace") as file:
            status = process.call(command, seconds=left, cwd=ROOT, env=environment, stdout=file,
                                  stderr=subprocess.STDOUT)
            if status and time.monotonic() >= deadline:
                return "left out", "", 0.0
            if status:
                file.seek(0)
                return "failed", "".join(file.readlines()[-40:]), 0.0
    unit.passed.parent.mkdir(exist_ok=True)
    unit.passed.touch()
    return "passed", "", time.monotonic() - begin


def run_units(ordered, deadline, seconds):
    """(passed, failed, left out) as lists of units; `seconds` learns what each took."""
    def one(unit):
        # What will not come to its end is not begun.
        if time.monotonic() + seconds.get(unit.name, 0.0) > deadline:
            return "left out", "", 0.0
        return judge(unit, deadline)
    found = {"passed": [], "failed": [], "left out": []}
    with concurrent.futures.ThreadPoolExecutor(process.jobs()) as pool:
        for unit, (status, text, took) in zip(ordered, pool.map(one, ordered)):
            found[status].append(unit)
            if status == "failed":
                say(f"FAILED {unit.folder}/{unit.source.name}\n{text}")
            if status == "passed":
                seconds[unit.name] = took
                say(f"passed {unit.folder}/{unit.source.name} in {took:.0f} s")
    return found["passed"], found["failed"], found["left out"]


def quick():
    begin = time.monotonic()
    packages.require("verify")
    build.build("quick", "crossbeam_verify_support")
    every = units()
    since = {unit: unit.edited() for unit in every}
    edited = edited_by_git().union(*(files for files in since.values() if files))
    stale = [unit for unit in every if since[unit] is None or since[unit]]

    faults = check_repository(edited)
    faults += [f"{name} does not compile alone" for name in compile_alone(headers_among(edited))]

    memory = BUILD / "seconds.json"
    seconds = json.loads(memory.read_text(encoding="utf-8")) if memory.exists() else {}
    passed, failed, left = run_units(in_order(stale, edited, seconds), begin + LIMIT, seconds)
    memory.write_text(json.dumps(seconds, indent=1), encoding="utf-8")

    say(f"{len(every) - len(stale)} test files are up to date, {len(passed)} passed, "
        f"{len(failed)} failed, {len(left)} left out, in {time.monotonic() - begin:.0f} s")
    if left:
        say("Left out for want of time; the next call goes on with them: "
            + " ".join(f"{unit.folder}/{unit.source.stem}" for unit in left))
    say("Left out always: long tests, the drape, SUNDIALS, examples, packaging, fuzzing, mutants; "
        "./run verify has them.")
    faults += [f"{unit.folder}/{unit.source.name}" for unit in failed]
    if faults:
        say("FAILED: " + ", ".join(faults))
    return 1 if faults else 0
