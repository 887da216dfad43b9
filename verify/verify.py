#!/usr/bin/env python3
"""Builds and runs the verification: `./run verify [--quick | --full]`; also `./run mutate` and
`./run report`. The parts, and what a run leaves out, are listed in PARTS; the page is made by
report/report.py, --quick by quick.py.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from setup import ROOT, Failure, build, main, packages, process, say  # noqa: E402

OUT = ROOT / "out" / "verify"
REPORT = ROOT / "verify" / "report" / "report.py"
MUTATION = ROOT / "verify" / "mutation"
REPORT_MODULES = ["jinja2", "matplotlib"]

# Tests that take long: their name ends so, or they carry this label (other compilers and
# instruction sets).
LONG_NAME, LONG_LABEL = r"\(long\)$", "^portability$"
# Under sanitizers: what the sanitizers do not look at.
NOT_SANITIZED = r"\(long\)$|^repository\.|^packaging\.|^report\.|^setup\."


class Parts:
    """The parts of a run, in order, each with what became of it (passed, failed or left out) and what
    it took."""

    def __init__(self):
        self.list = []
        self.begin = time.monotonic()

    def add(self, name, status, note=""):
        now = time.monotonic()
        self.list.append({"name": name, "status": status, "note": note,
                          "seconds": round(now - self.begin, 1)})
        self.begin = now
        if status != "passed":
            say(f"{name}: {status}" + (f" ({note})" if note else ""))

    def passed(self, name, good, note=""):
        self.add(name, "passed" if good else "failed", note)
        return good

    @property
    def failed(self):
        return [part["name"] for part in self.list if part["status"] == "failed"]


# --------------------------------------------------------------------------------------------------
# The parts


def run_tests(preset, *selection):
    """ctest's exit status. What the tests measured is in out/verify/<preset>-measured.jsonl, one
    line of JSON for each comparison or plot."""
    log = OUT / f"{preset}-measured.jsonl"
    log.write_text("", encoding="utf-8")
    return process.call(
        ["ctest", "--test-dir", ROOT / "build" / preset, "--parallel", process.jobs(),
         "--output-on-failure", "--no-tests=error", "--output-junit", OUT / f"{preset}.xml",
         *selection], env={**os.environ, "CROSSBEAM_CLAIMS_LOG": str(log)})


def all_tests(preset):
    """Every test that exists, for the report to tell what was left out."""
    text = process.output(["ctest", "--test-dir", ROOT / "build" / preset, "--show-only=json-v1"])
    if text is None:
        raise Failure(f"ctest does not list the tests of build/{preset}")
    file = OUT / f"{preset}-tests.json"
    file.write_text(text, encoding="utf-8")
    return file


def fuzzing(parts, seconds, without):
    if "libFuzzer" in without:
        parts.add("fuzzing", "left out", "no clang++ with libFuzzer here")
        return
    sys.path.insert(0, str(ROOT / "verify" / "fuzz"))
    import fuzz
    parts.passed("fuzzing", fuzz.fuzz(seconds, OUT / "verify-measured.jsonl"),
                 f"{seconds} s for each target")


def run_mutants(*arguments):
    return process.call([sys.executable, MUTATION / "mutate.py", ROOT / "build" / "verify",
                         OUT / "mutation.json", "--jobs", process.jobs(), *arguments])


def recorded_mutation():
    """The record of the last mutation run, with the headers changed since, as a file for the report;
    None where there is no record."""
    file = OUT / "mutation-record.json"
    file.unlink(missing_ok=True)
    if (MUTATION / "record.json").exists():
        process.call([sys.executable, MUTATION / "record.py", "--out", file])
    return file if file.exists() else None


def mutation(parts, full):
    """The result for the report: that of this run, or the record of the last one."""
    if not full:
        parts.add("mutation run", "left out", "the record of the last one is shown")
    elif parts.failed:  # mutants are judged by tests that pass without them
        parts.add("mutation run", "left out", "tests fail without any mutant")
    else:
        parts.passed("mutation run", run_mutants("--strict") == 0)
    fresh = OUT / "mutation.json"
    return fresh if fresh.exists() else recorded_mutation()


def own_laws(python):
    """The examples of a user's own law: one that holds, one with an error that has to show."""
    for name, expected in (("toe_yarn", 0), ("wrong_yarn", 1)):
        log = OUT / f"{name}.jsonl"
        process.call([ROOT / "build" / "verify" / "verify" / "examples" / f"example_{name}", log],
                     stdout=subprocess.DEVNULL)
        if process.call([python, REPORT, "--log", log, "--out", OUT / name],
                        stdout=subprocess.DEVNULL) != expected:
            return False
    say("A yarn of one's own, right and wrong: out/verify/toe_yarn, out/verify/wrong_yarn")
    return True


def sanitized(parts, full):
    name = "the whole suite under sanitizers"
    if not full:
        parts.add(name, "left out")
        return
    build.build("asan-ubsan")
    parts.passed(name, run_tests("asan-ubsan", "--exclude-regex", NOT_SANITIZED,
                                 "--label-exclude", LONG_LABEL) == 0)


# --------------------------------------------------------------------------------------------------
# The commands


def verify_all(full):
    begin = time.monotonic()
    without = packages.require("verify")
    if full:
        without |= packages.require("full")
    python = packages.python_with(REPORT_MODULES)
    OUT.mkdir(parents=True, exist_ok=True)
    # A run that does not come to its end leaves no report, neither an old one nor half a new one.
    for name in ("report.html", "report.json", "mutation.json"):
        (OUT / name).unlink(missing_ok=True)
    parts = Parts()
    build.build("verify")
    parts.add("building", "passed")
    selection = [] if full else ["--exclude-regex", LONG_NAME, "--label-exclude", LONG_LABEL]
    parts.passed("tests", run_tests("verify", *selection) == 0)
    fuzzing(parts, 60 if full else 10, without)
    parts.passed("laws of one's own", own_laws(python))
    sanitized(parts, full)
    result = mutation(parts, full)
    for name in sorted(without - {"libFuzzer"}):
        parts.add(name, "left out", "not installed")

    file = OUT / "parts.json"
    file.write_text(json.dumps(parts.list, indent=1), encoding="utf-8")
    status = process.call(
        [python, REPORT, "--out", OUT, "--claims", ROOT / "verify" / "README.md",
         "--log", OUT / "verify-measured.jsonl", "--junit", OUT / "verify.xml",
         "--tests", all_tests("verify"), "--parts", file,
         "--build", ROOT / "build" / "verify" / "verify" / "build.json",
         *(["--mutation", result] if result else [])])
    if status == 0 and parts.failed:
        raise Failure("the report says that all is well, and yet failed: " + ", ".join(parts.failed))
    say("Took: " + ", ".join(f"{part['name']} {part['seconds']:.0f} s" for part in parts.list
                             if part["seconds"] >= 1))
    if status == 0:
        say(f"All tests passed in {time.monotonic() - begin:.0f} s")
    return status


def verify(arguments):
    parser = argparse.ArgumentParser(prog="run verify", description="Builds and runs the "
                                     "verification; the report is out/verify/report.html.")
    extent = parser.add_mutually_exclusive_group()
    extent.add_argument("--quick", action="store_true", help="after an edit, at most three minutes: "
                        "the repository's checks, the edited headers alone, the tests nearest to them")
    extent.add_argument("--full", action="store_true", help="also the long claims, the mutation run, "
                        "sanitizers, an installed crossbeam, other compilers")
    options = parser.parse_args(arguments)
    if options.quick:
        import quick
        return quick.quick()
    return verify_all(options.full)


def mutate(arguments):
    packages.require("mutate")
    build.configure("verify")
    OUT.mkdir(parents=True, exist_ok=True)
    return run_mutants(*arguments)


def report(arguments):
    packages.require("report")
    return process.call([packages.python_with(REPORT_MODULES), REPORT, *arguments])


if __name__ == "__main__":
    main({"verify": verify, "mutate": mutate, "report": report}[sys.argv[1]], sys.argv[2:])
