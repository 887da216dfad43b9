#!/usr/bin/env python3
"""The commands of `run` that drape: drape, reference, precision (`./run bench precision`)."""

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from setup import ROOT, Failure, build, main, packages, process, say  # noqa: E402

ONLY_TEXT = {"-h", "--help", "--help-all", "--version"}
REPORT = ROOT / "drape_demo" / "report"


def folder_asked_for(arguments):
    """What --out says, or None."""
    folder = None
    for previous, argument in zip([""] + arguments, arguments):
        if argument.startswith("--out="):
            folder = argument.removeprefix("--out=")
        if previous == "--out":
            folder = argument
    if folder == "":
        raise Failure("--out wants a folder, not an empty word")
    return folder


def drape(arguments):
    program = ROOT / "build" / "drape" / "drape_demo" / "crossbeam-drape"
    out = folder_asked_for(arguments)
    packages.require("drape")
    build.build("drape", "crossbeam-drape")
    if ONLY_TEXT & set(arguments):
        return process.call([program, *arguments])
    if out is None:
        out = ROOT / "out" / "drape"
        make_folder(out.parent)
        arguments = [*arguments, "--out", out]
    status = process.call([program, *arguments])
    if status:
        return status
    python = packages.python_with(["matplotlib", "meshio"])
    if not python:
        say("No pictures: Python has no matplotlib or no meshio. The tables and frames are in", out)
        return 0
    return process.call([python, REPORT / "pictures.py", out])


def reference(arguments):
    packages.require("reference")
    build.build("reference", "crossbeam-reference")
    program = ROOT / "build" / "reference" / "drape_demo" / "crossbeam-reference"
    return process.call([program, "--out", ROOT / "out" / "reference", *arguments])


def precision(arguments):
    packages.require("precision")
    build.build("reference", "crossbeam-precision")
    program = ROOT / "build" / "reference" / "drape_demo" / "crossbeam-precision"
    out = ROOT / "out" / "precision"
    status = process.call([program, "--jobs", process.jobs(), "--out", out, *arguments])
    if status or ONLY_TEXT & set(arguments):
        return status
    return process.call([packages.python_with(["jinja2", "matplotlib"]), REPORT / "precision.py",
                         out])


def make_folder(folder):
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as error:
        raise Failure(f"cannot make the folder {folder}: {error.strerror}") from error


if __name__ == "__main__":
    command = {"drape": drape, "reference": reference, "precision": precision}[sys.argv[1]]
    main(command, sys.argv[2:])
