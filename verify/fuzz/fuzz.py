#!/usr/bin/env python3
"""Attacks cell, law and scene reader with libFuzzer: `./run fuzz [seconds]`, and a part of
`./run verify`. Logs, corpora and findings go to out/fuzz, what came of it to out/verify/fuzz.json.
"""

import argparse
import concurrent.futures
import json
import os
import re
import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent.parent))
from setup import ROOT, Failure, build, main, packages, process, say  # noqa: E402

CLAIMS = {"cell": "V-STRESS-09", "law": "V-STRESS-09", "scene": "V-STRESS-10"}  # of the targets
SCENES = ROOT / "drape_demo" / "scene"
REPEAT = ("repeat one with build/fuzz/verify/fuzz/crossbeam-fuzz-<target> "
          "out/fuzz/<target>-finding-<...>")


def names_of(scenes):
    """The names of the fields in scene files, as a dictionary of libFuzzer."""
    found = {name for scene in scenes
             for name in re.findall(r"^ *([a-z_]+) *=", scene.read_text(encoding="utf-8"), re.M)}
    return "".join(f'"{name}"\n' for name in sorted(found))


def options_of(target, out):
    """What a target gets besides the time; the scene reader starts from the program's scenes."""
    corpus = out / f"{target}-corpus"
    corpus.mkdir(parents=True)
    options = ["-max_len=160"]
    if target == "scene":
        scenes = sorted(SCENES.glob("*.toml"))
        for scene in scenes:
            shutil.copy(scene, corpus)
        (out / "names").write_text(names_of(scenes), encoding="utf-8")
        options = ["-max_len=8192", f"-dict={out / 'names'}"]
    return [*options, f"-artifact_prefix={out / target}-finding-", corpus]


def attack(target, seconds, out):
    """Runs one target; its log is in the folder `out`."""
    command = [ROOT / "build" / "fuzz" / "verify" / "fuzz" / f"crossbeam-fuzz-{target}", "-seed=1",
               f"-max_total_time={seconds}", "-timeout=5", "-rss_limit_mb=2048",
               "-print_final_stats=1", *options_of(target, out)]
    with open(out / f"{target}.log", "wb") as log:
        process.call(command, stdout=log, stderr=log)
    return result_of((out / f"{target}.log").read_text(encoding="utf-8", errors="replace"), seconds,
                     len(list(out.glob(f"{target}-finding-*"))))


def result_of(log, seconds, findings):
    """What a log says. A target that did not run to its end has a finding, with or without a file."""
    def number(pattern):
        found = re.findall(pattern, log, re.M)
        return int(found[-1]) if found else 0
    if not findings and not re.search(r"^Done ", log, re.M):
        findings = 1
    return {"runs": number(r"^stat::number_of_executed_units: *(\d+)"), "seconds": seconds,
            "exec_per_s": number(r"^stat::average_exec_per_sec: *(\d+)"), "findings": findings,
            "coverage": number(r" cov: (\d+) ")}


def measurement(target, result):
    """A line for the report's log: no findings is what the claim says."""
    return {"kind": "measurement", "id": CLAIMS[target], "measured": result["findings"],
            "tolerance": 0, "bound": "upper", "pass": result["findings"] == 0,
            "note": f"findings of libFuzzer in the {target}: {result['runs']} runs in "
                    f"{result['seconds']} s"}


def fuzz(seconds, log=None):
    """All targets side by side; whether nothing was found. Measurements are appended to `log`."""
    build.build("fuzz")
    out, results = ROOT / "out" / "fuzz", ROOT / "out" / "verify" / "fuzz.json"
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    results.parent.mkdir(parents=True, exist_ok=True)
    with concurrent.futures.ThreadPoolExecutor(len(CLAIMS)) as pool:
        found = dict(zip(CLAIMS, pool.map(lambda target: attack(target, seconds, out), CLAIMS)))
    for target, result in found.items():
        say(f"fuzz: {target}: {result['runs']} runs in {seconds} s, {result['findings']} findings")
        if result["findings"]:
            text = (out / f"{target}.log").read_text(encoding="utf-8", errors="replace")
            print("\n".join(text.splitlines()[-40:]), file=sys.stderr)
    partial = results.with_suffix(".json.partial")
    partial.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    os.replace(partial, results)
    if log:
        with open(log, "a", encoding="utf-8") as file:
            file.writelines(json.dumps(measurement(*one)) + "\n" for one in found.items())
    return all(result["findings"] == 0 for result in found.values())


def positive(text):
    if not re.fullmatch(r"[1-9][0-9]*", text):
        raise argparse.ArgumentTypeError(f"a whole number of seconds is wanted, not {text!r}")
    return int(text)


def command(arguments):
    parser = argparse.ArgumentParser(prog="run fuzz", description=__doc__)
    parser.add_argument("seconds", type=positive, nargs="?", default=20, help="for each target")
    options = parser.parse_args(arguments)
    packages.require("fuzz")
    if not fuzz(options.seconds):
        raise Failure(f"there are findings; {REPEAT}")
    return 0


if __name__ == "__main__":
    main(command, sys.argv[2:])
