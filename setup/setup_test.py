"""Tests of what the commands of `run` share, and of `run` itself: python3 setup_test.py"""

import contextlib
import io
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from unittest import mock

sys.dont_write_bytecode = True
if sys.version_info < (3, 11):
    print("setup_test: skipped, needs Python 3.11")
    sys.exit(77)
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from setup import ROOT, Failure, build, packages, process  # noqa: E402

RUN = ROOT / "run"


def need(name, kind="package", commands=("drape",)):
    return packages.Need(kind, name, f"lib{name}-dev", name, name, commands)


class Packages(unittest.TestCase):
    def test_the_table(self):
        table = packages.read_table()
        self.assertEqual(len({row.name for row in table}), len(table))
        for row in table:
            self.assertIn(row.kind, ("tool", "program", "package", "module"))
            self.assertTrue(row.kind != "tool" or row.name in packages.TOOLS, row.name)
        wanted = {row.name for row in table if row.wanted_by("drape")}
        self.assertTrue({"cmake", "c++", "Eigen3", "CLI11", "matplotlib"} <= wanted)
        self.assertFalse({"doctest", "SUNDIALS"} & wanted)

    def refused(self, missing, right=None):
        with mock.patch.object(packages, "missing_for", return_value=missing), \
                mock.patch.object(packages, "right_to_install", return_value=right), \
                mock.patch.object(packages, "install") as install:
            with self.assertRaises(Failure) as refusal:
                packages.require("drape")
        return str(refusal.exception), install

    def test_names_what_is_missing(self):
        text, install = self.refused([need("foo")])
        self.assertRegex(text, r"foo +apt: libfoo-dev +brew: foo +conda: foo")
        install.assert_not_called()

    def test_without_a_compiler_all_packages_are_named(self):
        with mock.patch.dict(packages.TOOLS, {"c++": lambda: False}):
            text, _ = self.refused(packages.missing_for("drape"))
        for name in ("g++", "libeigen3-dev", "libcli11-dev"):
            self.assertIn(name, text)
        self.assertNotIn("doctest", text)

    def test_what_is_optional_may_fail_to_install(self):
        for commands, raises in ((("drape?",), False), (("drape",), True)):
            with mock.patch.object(packages, "missing_for",
                                   return_value=[need("plots", "module", commands)]), \
                    mock.patch.object(packages, "right_to_install", return_value=([], "as root")), \
                    mock.patch.object(packages, "install", side_effect=Failure("no network")), \
                    contextlib.redirect_stdout(io.StringIO()):
                if raises:
                    with self.assertRaisesRegex(Failure, "no network"):
                        packages.require("drape")
                else:
                    self.assertEqual(packages.require("drape"), {"plots"})

    def test_installs_in_vain(self):
        text, install = self.refused([need("foo")], ([], "as root"))
        self.assertIn("still not found after installing", text)
        install.assert_called()

    def test_does_without_what_is_optional(self):
        with mock.patch.object(packages, "missing_for",
                               return_value=[need("plots", "module", ("drape?",))]), \
                mock.patch.object(packages, "right_to_install", return_value=None):
            self.assertEqual(packages.require("drape"), {"plots"})

    def test_no_right(self):
        with mock.patch.dict(os.environ, {"CROSSBEAM_NO_INSTALL": "1"}):
            self.assertIsNone(packages.right_to_install())

    def test_a_folder_that_cannot_be_written_to(self):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "build").write_text("a file", encoding="utf-8")
            with mock.patch.object(packages, "ROOT", Path(folder)), \
                    self.assertRaisesRegex(Failure, "cannot write to"):
                packages.open_log("x")


class Builds(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.24)\nproject(small LANGUAGES CXX)\n"
            "add_custom_target(fails COMMAND false)\n", encoding="utf-8")
        (self.root / "CMakePresets.json").write_text(json.dumps({
            "version": 5,
            "configurePresets": [{"name": "p", "binaryDir": "${sourceDir}/build/p"}],
            "buildPresets": [{"name": "p", "configurePreset": "p"}]}), encoding="utf-8")
        for module in (build, packages):
            patch = mock.patch.object(module, "ROOT", self.root)
            patch.start()
            self.addCleanup(patch.stop)

    def test_another_compiler_is_taken_and_named(self):
        mine = self.root / "my-c++"
        mine.write_text('#!/bin/sh\nexec c++ "$@"\n', encoding="utf-8")
        mine.chmod(0o755)
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            build.build("p")
            with mock.patch.dict(os.environ, {"CXX": str(mine)}):
                build.build("p")
            build.build("p")
        compilers = re.findall(r"with (\S+) \(log", said.getvalue())
        self.assertEqual(compilers[1], str(mine))
        self.assertEqual([compilers[0] == str(mine), compilers[2] == compilers[0]], [False, True])

    def test_a_failure_shows_the_log(self):
        with contextlib.redirect_stdout(io.StringIO()), \
                self.assertRaisesRegex(Failure, "(?s)fails.*Error 1.*building fails failed; the whole"):
            build.build("p", "fails")


class Signals(unittest.TestCase):
    """Programs end when `run` is asked to end, and so does what they started."""

    PARENT = (f"import sys; sys.path.insert(0, {str(ROOT)!r})\n"
              "from setup import main, process\n"
              "main(lambda _: process.call(['sh', '-c', 'sleep 60 & echo $$ $!; wait; echo on']), [])")

    def ended_by(self, number, **options):
        parent = subprocess.Popen([sys.executable, "-B", "-c", self.PARENT], text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)
        children = [int(word) for word in parent.stdout.readline().split()]
        os.kill(parent.pid, number)
        try:
            parent.wait(10)
        except subprocess.TimeoutExpired:
            for child in children:
                os.kill(child, signal.SIGKILL)
        out, err = parent.communicate()
        self.assertEqual((out, err), ("", ""))
        return parent.returncode, children

    def test_each(self):
        for number in process.FORWARDED:
            status, children = self.ended_by(number)
            self.assertEqual(status, -number)
            time.sleep(0.2)
            for child in children:
                self.assertFalse(alive(child), f"{child} after {number!r}")

    def test_what_was_ignored_stays_ignored(self):
        parent = subprocess.Popen(
            ["sh", "-c", "trap '' HUP; exec \"$@\"", "sh", sys.executable, "-B", "-c",
             self.PARENT.replace("sleep 60", "sleep 1")], text=True, stdout=subprocess.PIPE)
        parent.stdout.readline()
        os.kill(parent.pid, signal.SIGHUP)
        out, _ = parent.communicate(timeout=20)
        self.assertEqual((parent.returncode, out), (0, "on\n"))

    def test_limit_of_time(self):
        begin = time.monotonic()
        self.assertNotEqual(process.call(["sleep", "30"], seconds=0.2), 0)
        self.assertLess(time.monotonic() - begin, 10)


def alive(pid):
    """Whether a process runs; one that nobody waited for does not."""
    text = process.output(["ps", "-o", "stat=", "-p", pid])
    return bool(text) and not text.strip().startswith("Z")


class Run(unittest.TestCase):
    def run_it(self, *command, **options):
        return subprocess.run(command, capture_output=True, text=True, check=False, **options)

    def test_from_anywhere(self):
        with tempfile.TemporaryDirectory() as folder:
            link = Path(folder) / "x"
            link.symlink_to(RUN)
            chain = Path(folder) / "y"
            chain.symlink_to("x")
            environment = {**os.environ, "CDPATH": "/:/usr"}
            for words in ([RUN], ["sh", RUN], ["bash", RUN], [link], [chain], ["sh", "./y"]):
                got = self.run_it(*map(str, words), "fuzz", "no number", cwd=folder,
                                  env=environment)
                self.assertIn("a whole number of seconds is wanted", got.stderr, words)
                self.assertEqual(got.returncode, 2)
            self.assertEqual(sorted(os.listdir(folder)), ["x", "y"])

    def test_help_and_unknown_commands(self):
        self.assertEqual(self.run_it(RUN).returncode, 0)
        for command in ("drape", "verify", "report", "mutate", "fuzz", "reference", "bench"):
            self.assertIn(f"\n  {command} ", self.run_it(RUN, "help").stdout)
        got = self.run_it(RUN, "nonsense")
        self.assertEqual(got.returncode, 2)
        self.assertIn("run: unknown command nonsense", got.stderr)

    def test_an_empty_folder_for_results(self):
        for words in (["--out", ""], ["--out="]):
            got = self.run_it(RUN, "drape", *words)
            self.assertEqual((got.returncode, got.stderr),
                             (2, "run: --out wants a folder, not an empty word\n"))

    def test_without_python(self):
        """What is missing is named in the words of all package managers."""
        with tempfile.TemporaryDirectory() as folder:
            for tool in ("sh", "dirname", "readlink", "id"):
                Path(folder, tool).symlink_to(f"/usr/bin/{tool}" if Path(f"/usr/bin/{tool}").exists()
                                              else f"/bin/{tool}")
            text = RUN.read_text(encoding="utf-8").replace("/usr/bin/python3 ", "")
            copy = Path(folder, "run")
            copy.write_text(text, encoding="utf-8")
            Path(folder, "setup").symlink_to(ROOT / "setup")
            got = self.run_it("/bin/sh", str(copy), "bench", "precision",
                              env={"PATH": folder, "CROSSBEAM_NO_INSTALL": "1"})
            self.assertEqual(got.returncode, 2)
            self.assertRegex(got.stderr, "python +apt: python3 +brew: python +conda: python")
            self.assertIn("libsundials-dev", got.stderr)
            self.assertNotIn("doctest", got.stderr)

    def test_length(self):
        self.assertLessEqual(len(RUN.read_text(encoding="utf-8").splitlines()), 150)


if __name__ == "__main__":
    unittest.main()
