"""Runs the mutation test of the library's headers (README.md).

    mutate.py <build folder> <report .json> [--changed | --file cell | --suite kernels] [--record]
              [--mutant N] [--list] [--sample N] [--strict] [--jobs N]

Without options: builds the kill suites, runs them once per mutant and writes the report. --record
puts the result into record.json, which ctest checks to be current for every header; --changed does so
for the headers that have changed since the record. With --strict the exit status is 1 where the score
is below the aim, where a survivor has no reason in survivors.toml, or a reason no survivor.
"""

import argparse
import concurrent.futures
import datetime
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import time

import instrument
import record
from record import key_of

HERE = pathlib.Path(__file__).resolve().parent
REPOSITORY = HERE.parent.parent
# Seconds of processor time; the tests that reach a mutant run cheapest first, in portions.
PORTIONS = (0.03, 0.15, 0.5, 1.5, 5, 1e9)
# Take longer than all others together: relaxations, and a scan of random states.
LEFT_OUT = {"V-ELEM-08", "V-ELEM-09", "V-CELL-30"}
# Address space of a mutant: one that asks for memory without end must not get the machine's.
MEGABYTES = 4000
# Seconds without a step of the processor after which all threads wait for each other.
STUCK = 5
ERROR_AT = re.compile(r"(crossbeam/[\w/]+\.hpp):(\d+):")
INCLUDE = re.compile(r'^\s*#include "([^"]+)"', re.MULTILINE)


class Failure(RuntimeError):
    pass


class Program:
    """The tests of one file, compiled against the instrumented headers of a suite."""

    def __init__(self, target, path, source):
        self.target, self.path, self.source = target, pathlib.Path(path), pathlib.Path(source)


def programs_of(folder):
    return [Program(*line.split()) for line in (folder / "programs.txt").read_text().splitlines()]


def includes(source):
    """All files of the repository that a file includes, itself as well."""
    roots = [REPOSITORY / "include", REPOSITORY / "verify", REPOSITORY / "drape_demo/src",
             REPOSITORY / "drape_demo/reference"]
    found, new = set(), [source]
    while new:
        file = new.pop()
        if file in found:
            continue
        found.add(file)
        for name in INCLUDE.findall(file.read_text()):
            new += [root / name for root in [file.parent, *roots] if (root / name).exists()]
    return found


def build_suite(build, folder, targets, jobs):
    """Lines that do not compile with mutants are left alone; they are returned."""
    dropped = folder / "dropped.txt"
    dropped.unlink(missing_ok=True)
    (folder / "instrumented").unlink(missing_ok=True)
    lines = set()
    for _ in range(8):
        run = subprocess.run(["cmake", "--build", str(build), "--parallel", str(jobs), "--target",
                              *targets], capture_output=True, text=True)
        if run.returncode == 0:
            return sorted(lines)
        log = run.stdout + run.stderr
        found = {f"{file}:{line}" for text in log.split("\n") if "error" in text or "required" in text
                 for file, line in ERROR_AT.findall(text)}
        if not found - lines:
            raise Failure(log[-4000:] + "\nThe kill suite does not build.")
        lines |= found
        dropped.write_text("\n".join(sorted(lines)) + "\n")
        (folder / "instrumented").unlink(missing_ok=True)
    raise Failure("The kill suite does not build without these lines either: " + " ".join(lines))


def call(program, tests, extra, limit=None):
    environment = {k: v for k, v in os.environ.items() if not k.startswith("CROSSBEAM_")}
    environment.update(extra)
    if limit:
        environment["CROSSBEAM_MUTANT_SECONDS"] = f"{limit:.2f}"
        environment["CROSSBEAM_MUTANT_MEGABYTES"] = str(MEGABYTES)
    command = [str(program), "--abort-after=1", "--no-breaks", "--no-path-filenames=1"]
    left_out = ["*(long)*"]
    if tests is not None:
        command.append("--test-case=" + ",".join(t + "*" for t in sorted(tests)))
    else:
        left_out += [t + "*" for t in sorted(LEFT_OUT)]
    command.append("--test-case-exclude=" + ",".join(left_out))
    return command, environment


def test_id(name):
    match = re.match(r"[\w-]+", name)
    return match.group() if match else name


def baseline(program, scratch):
    """Seconds of each test, and the tests that reach each site, with no mutant switched on. A test is
    a pair of program and name."""
    coverage = scratch / f"{program.name}.coverage"
    command, environment = call(program, None, {"CROSSBEAM_MUTATION_COVERAGE": str(coverage)})
    run = subprocess.run(command, env=environment, capture_output=True, text=True)
    if run.returncode != 0:
        raise Failure(run.stdout[-4000:] + f"\n{program.name} fails without any mutant.")
    seconds, reached_by = {}, {}
    for line in coverage.read_text().splitlines():
        name, took, sites = line.split("\t")
        test = program, test_id(name)
        seconds[test] = seconds.get(test, 0.0) + float(took)
        for site in sites.split():
            reached_by.setdefault(int(site), set()).add(test)
    return seconds, reached_by


def baselines(programs, scratch, jobs):
    seconds, reached_by = {}, {}
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for its_seconds, its_sites in pool.map(lambda p: baseline(p.path, scratch), programs):
            seconds |= its_seconds
            for site, tests in its_sites.items():
                reached_by.setdefault(site, set()).update(tests)
    return seconds, reached_by


def portions(tests, seconds):
    """The tests in portions of one program each, cheapest first."""
    out, total, limits = [], 0.0, iter(PORTIONS)
    limit, group = next(limits), {}
    for test in sorted(tests, key=lambda t: (seconds[t], t)):
        total += seconds[test]
        while total > limit:
            limit = next(limits)
            out += group.items()
            group = {}
        group.setdefault(test[0], []).append(test[1])
    return out + list(group.items())


def processor_time(pid):
    """Clock ticks that the threads of a process have used, and whether all of them sleep."""
    ticks, asleep = 0, True
    for thread in pathlib.Path(f"/proc/{pid}/task").iterdir():
        fields = (thread / "stat").read_text().rpartition(")")[2].split()
        ticks += int(fields[11]) + int(fields[12])
        asleep = asleep and fields[0] == "S"
    return ticks, asleep


def run_limited(command, environment, limit):
    """Exit status, or None for a program that hangs."""
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    end, before, stuck = time.monotonic() + limit, None, 0
    while True:
        try:
            return process.wait(timeout=1)
        except subprocess.TimeoutExpired:
            try:
                ticks, asleep = processor_time(process.pid)
                stuck = stuck + 1 if asleep and ticks == before else 0
                before = ticks
            except OSError:
                pass  # no /proc, or just gone
        if stuck >= STUCK or time.monotonic() > end:
            process.kill()
            process.wait()
            return None


def judge(mutant, seconds, reached_by):
    """killed | survived | not applicable, and by what or why."""
    tests = reached_by.get(mutant["site"], set())
    if not tests:
        return "survived", "not reached by any test"
    differed = False
    for program, names in portions(tests, seconds):
        limit = 0.5 + 5 * sum(seconds[program, t] for t in names)
        command, environment = call(
            program, names, {"CROSSBEAM_MUTANT": f"{mutant['site']}:{mutant['variant']}"}, limit)
        status = run_limited(command, environment, 60 + 20 * limit)
        if status == 77:
            return "not applicable", "no such operation for these types"
        if status not in (0, 70, 71):
            return "killed", "hangs" if status in (None, -26) else "crashes" if status < 0 else "test"
        differed = differed or status == 0
    return "survived", "" if differed else "never changed a value"


def show(mutant):
    return (f"{mutant['id']:5} {mutant['file']}:{mutant['line']} {mutant['kind']}: "
            f"{mutant['before']}  =>  {mutant['after'] or '(nothing)'}")


def summary(mutants, results, explanations, seconds, dropped, total=None):
    """total: mutants of each header, where not all were judged."""
    report = {"score": 0.0, "mutants": len(mutants), "killed": 0, "not_applicable": 0,
              "survivors": [], "per_file": {}, "by_kind": {}, "killed_by": {},
              "lines_without_mutants": dropped}
    for mutant, (verdict, how) in zip(mutants, results):
        groups = (report["per_file"].setdefault(mutant["file"], {}),
                  report["by_kind"].setdefault(mutant["kind"], {}))
        for group in groups:
            for field in record.COUNTS:
                group.setdefault(field, 0)
            group["mutants"] += 1
            group["judged"] += 1
        field = {"killed": "killed", "not applicable": "not_applicable",
                 "survived": "survivors"}[verdict]
        for group in groups:
            group[field] += 1
        if verdict == "survived":
            report["survivors"].append(
                {k: mutant[k] for k in ("id", "file", "line", "kind", "before", "after", "text",
                                        "change")} |
                {"note": how, "explanation": explanations.get(key_of(mutant), "")})
        else:
            report[field] += 1
            if verdict == "killed":
                report["killed_by"][how] = report["killed_by"].get(how, 0) + 1
    for name, counts in report["per_file"].items():
        counts["mutants"] = (total or {}).get(name, counts["judged"])
    applicable = report["mutants"] - report["not_applicable"]
    report["score"] = report["killed"] / applicable if applicable else 0.0
    report["seconds"] = round(seconds, 1)
    return report


def sample(mutants, size):
    """So many mutants of every folder, always the same ones."""
    chosen, folders = [], {}
    for m in mutants:
        folders.setdefault(m["file"].split("/")[1], []).append(m)
    for group in folders.values():
        group.sort(key=lambda m: hashlib.sha256("|".join(key_of(m)).encode()).digest())
        chosen += group[:size]
    return sorted(chosen, key=lambda m: m["id"])


def commit():
    try:
        said = [subprocess.run(["git", "-C", str(REPOSITORY), *words], capture_output=True, text=True,
                               check=True).stdout.strip()
                for words in (["rev-parse", "--short=10", "HEAD"],
                              ["status", "--porcelain", "include"])]
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return said[0] + ("+" if said[1] else "")


class Suite:
    """One suite in the build folder: its mutants, built and measured on demand."""

    def __init__(self, name, build):
        self.name, self.build = name, build
        self.folder = build / "verify" / "mutation" / name
        if not self.folder.exists():
            self.folder = build / "mutation" / name  # verify/ as a project of its own

    def instrumented(self, only):
        """The mutants of these headers; all where None."""
        file = self.folder / "only.txt"
        if only is None:
            file.unlink(missing_ok=True)
        else:
            file.write_text("".join(f"{name}\n" for name in sorted(only)))
        return instrument.instrument(REPOSITORY / "include", self.folder, self.name, (), only)

    def prepare(self, only, jobs):
        """Builds the programs that include one of these headers, and runs them without mutants."""
        wanted = None if only is None else {REPOSITORY / "include" / name for name in only}
        programs = [p for p in programs_of(self.folder)
                    if wanted is None or includes(p.source) & wanted]
        begin = time.monotonic()
        self.dropped = build_suite(self.build, self.folder, [p.target for p in programs], jobs)
        self.seconds_of_building = time.monotonic() - begin
        self.mutants = json.loads((self.folder / "mutants.json").read_text())
        self.seconds, self.reached_by = baselines(programs, self.folder, jobs)


def one_mutant(suite, number):
    for m in suite.mutants:
        if m["id"] != number:
            continue
        print(show(m) + f"\n  in: {m['text']}")
        tests = suite.reached_by.get(m["site"], set())
        print("  reached by:", " ".join(sorted(t for _, t in tests)) or "no test")
        for program in sorted({p for p, _ in tests}):
            command, environment = call(
                program, [t for p, t in tests if p == program],
                {"CROSSBEAM_MUTANT": f"{m['site']}:{m['variant']}"})
            command.remove("--abort-after=1")
            subprocess.run(command, env=environment)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path, help="build folder of CMake")
    parser.add_argument("report", type=pathlib.Path)
    parser.add_argument("--changed", action="store_true",
                        help="the headers that have changed since the record, and record them")
    parser.add_argument("--record", action="store_true", help="put the result into record.json")
    parser.add_argument("--suite", choices=instrument.SUITES, help="one of the suites")
    parser.add_argument("--file", help="mutants of headers whose name contains this")
    parser.add_argument("--mutant", type=int,
                        help="one mutant of the suite: its line and what the tests say")
    parser.add_argument("--list", action="store_true", help="list the mutants and stop")
    parser.add_argument("--sample", type=int, metavar="N", help="N mutants of every folder")
    parser.add_argument("--strict", action="store_true",
                        help="fail below the aim, and on survivors without explanation")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--survivors", type=pathlib.Path, default=record.SURVIVORS)
    arguments = parser.parse_args()

    begin = time.monotonic()
    now, kept = record.fingerprints(), record.read()
    only = None
    if arguments.changed:
        only = {name for name in record.changed(kept, now) if name in now}
    if arguments.file:
        only = {name for name in (now if only is None else only) if arguments.file in name}
    if only is not None and not only:
        print("no header " + ("has changed since the record" if arguments.changed else
                              f"contains {arguments.file}"))
        if not arguments.changed:
            return 2
    suites = [Suite(name, arguments.build.resolve()) for name in instrument.SUITES
              if arguments.suite in (None, name) and
              (only is None or any(instrument.suite_of(n) == name for n in only))]
    explanations = record.read_explanations(arguments.survivors)

    mutants, results, dropped, built, total = [], [], [], 0.0, {}
    for suite in suites:
        of_suite = None if only is None else {n for n in only if instrument.suite_of(n) == suite.name}
        listed = suite.instrumented(of_suite)
        if arguments.list:
            print(f"{suite.name}\n" + "\n".join(show(m) for m in listed))
            continue
        suite.prepare(of_suite, arguments.jobs)
        if arguments.mutant:
            one_mutant(suite, arguments.mutant)
            continue
        built += suite.seconds_of_building
        for m in suite.mutants:
            total[m["file"]] = total.get(m["file"], 0) + 1
        chosen = sample(suite.mutants, arguments.sample) if arguments.sample else suite.mutants
        print(f"{suite.name}: {len(chosen)} of {len(suite.mutants)} mutants, "
              f"{len(suite.seconds)} tests of {sum(suite.seconds.values()):.0f} s, built in "
              f"{suite.seconds_of_building:.0f} s", flush=True)
        with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
            results += pool.map(lambda m: judge(m, suite.seconds, suite.reached_by), chosen)
        mutants += chosen
        dropped += suite.dropped
    if arguments.list or arguments.mutant:
        return 0

    report = summary(mutants, results, explanations, time.monotonic() - begin, dropped, total)
    report["seconds_of_building"] = round(built, 1)
    unexplained = [s for s in report["survivors"] if not s["explanation"]]
    alive = {key_of(s) for s in report["survivors"]}
    judged = set(report["per_file"])
    stale = sorted(k for k in explanations if k not in alive and not arguments.sample and
                   (k[0] in judged or k[0] not in now))
    record.write(arguments.report, report)
    if arguments.record or arguments.changed:
        for name in now:  # headers without an operator
            if instrument.suite_of(name) in [s.name for s in suites] and (only is None or
                                                                         name in only):
                report["per_file"].setdefault(name, dict.fromkeys(record.COUNTS, 0))
        date = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d")
        record.write(record.RECORD, record.merged(kept, report["per_file"], report["survivors"], now,
                                                  date, commit(), explanations))
    print(f"{report['killed']} of {report['mutants'] - report['not_applicable']} mutants killed, "
          f"{len(report['survivors'])} survive, {len(unexplained)} of them unexplained; "
          f"score {100 * report['score']:.1f} % in {report['seconds']:.0f} s "
          f"({report['seconds_of_building']:.0f} s of them building)")
    for s in unexplained:
        print("  unexplained: " + show(s) + (f"  ({s['note']})" if s["note"] else ""))
    for file, line, change in stale:
        print(f"  explained in survivors.toml, but killed or gone: {file}: {line}: {change}")
    below = report["score"] < record.AIM
    if below:
        print(f"  the score is below the aim of {100 * record.AIM:.0f} %")
    failed = arguments.strict and bool(below or unexplained or stale)
    return 1 if failed else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Failure as failure:
        print(f"mutate.py: {failure}", file=sys.stderr)
        sys.exit(2)
