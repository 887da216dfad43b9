"""Tests of verify.py and quick.py: python3 verify_test.py"""

import contextlib
import io
import json
import sys
import tempfile
import time
import unittest
from pathlib import Path
from unittest import mock

sys.dont_write_bytecode = True
if sys.version_info < (3, 11):
    print("verify_test: skipped, needs Python 3.11")
    sys.exit(77)
import verify  # noqa: E402, finds what the commands share
import quick  # noqa: E402


class Whole(unittest.TestCase):
    """What `./run verify` makes of what its parts say."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = Path(folder.name)

    def run_it(self, *arguments, tests=0, fuzzing=True, mutants=0, report=None, without=()):
        """The exit status; the report's is 1 where a part failed, as report.py has it."""
        self.calls = []

        def call(words, **_):
            words = [str(word) for word in words]
            self.calls.append(words)
            if words[0] == "ctest":
                return tests
            if "mutate.py" in words[1]:
                (self.out / "mutation.json").write_text('{"score": 1}', encoding="utf-8")
                return mutants
            if "--parts" in words:
                self.parts = {part["name"]: part["status"] for part in json.loads(
                    (self.out / "parts.json").read_text(encoding="utf-8"))}
                return report if report is not None else int("failed" in self.parts.values())
            return int("wrong_yarn.jsonl" in words[-1] or "wrong_yarn" in words[-1])
        sys.path.insert(0, str(verify.ROOT / "verify" / "fuzz"))
        import fuzz
        with mock.patch.object(verify, "OUT", self.out), \
                mock.patch.object(verify.packages, "require", return_value=set(without)), \
                mock.patch.object(verify.packages, "python_with", return_value="python3"), \
                mock.patch.object(verify.build, "build") as self.built, \
                mock.patch.object(verify.process, "call", side_effect=call), \
                mock.patch.object(verify.process, "output", return_value="{}"), \
                mock.patch.object(fuzz, "fuzz", return_value=fuzzing), \
                contextlib.redirect_stdout(io.StringIO()) as said:
            try:
                return verify.verify(list(arguments))
            finally:
                self.said = said.getvalue()

    def test_all_well(self):
        self.assertEqual(self.run_it(), 0)
        self.assertIn("All tests passed", self.said)
        self.assertEqual(self.parts["mutation run"], "left out")
        self.assertEqual(self.parts["the whole suite under sanitizers"], "left out")
        self.assertEqual([words for words in self.calls if "mutate.py" in words[1]], [])
        self.assertEqual([c.args[0] for c in self.built.call_args_list], ["verify"])

    def test_each_failure_fails_the_report_and_the_command(self):
        for failure in ({"tests": 8}, {"fuzzing": False}):
            self.assertEqual(self.run_it(**failure), 1, failure)
            self.assertNotIn("All tests passed", self.said)
        self.assertEqual(self.run_it("--full", mutants=1), 1)

    def test_a_report_that_does_not_know(self):
        with self.assertRaisesRegex(verify.Failure, "and yet failed: tests"):
            self.run_it(tests=8, report=0)

    def test_full(self):
        self.assertEqual(self.run_it("--full"), 0)
        self.assertNotIn("left out", self.parts.values())
        self.assertEqual([c.args[0] for c in self.built.call_args_list], ["verify", "asan-ubsan"])
        first = next(words for words in self.calls if words[0] == "ctest")
        self.assertNotIn("--exclude-regex", first)

    def test_mutants_are_judged_by_tests_that_pass(self):
        self.run_it("--full", tests=8)
        self.assertEqual(self.parts["mutation run"], "left out")

    def test_without_fuzzer_and_sympy(self):
        self.assertEqual(self.run_it(without=["libFuzzer", "sympy"]), 0)
        self.assertEqual((self.parts["fuzzing"], self.parts["sympy"]), ("left out", "left out"))

    def test_an_old_report_does_not_outlive_an_interrupted_run(self):
        for name in ("report.html", "report.json"):
            (self.out / name).write_text("old", encoding="utf-8")
        with mock.patch.object(verify, "run_tests", side_effect=verify.process.Ended), \
                self.assertRaises(verify.process.Ended):
            self.run_it()
        self.assertFalse(list(self.out.glob("report.*")))


class Quick(unittest.TestCase):
    def order(self, *edited):
        edited = {quick.ROOT / name for name in edited}
        return [f"{unit.folder}/{unit.source.stem}"
                for unit in quick.in_order(quick.units(), edited, {})]

    def test_own_folder_first(self):
        for header, folder in (("base/scalar", "unit_base"), ("cell/crossed_beam", "cell"),
                               ("contact/rigid_tool_contact", "contact"), ("law/shear", "law")):
            order = self.order(f"include/crossbeam/{header}.hpp")
            own = [unit for unit in order if unit.startswith(folder + "/")]
            self.assertTrue(own)
            self.assertEqual(set(order[:len(own)]), set(own))
            self.assertEqual(len(order), len(quick.units()))
        # Of that folder the test that has the header's name comes first.
        for header, test in (("law/shear", "law/shear_verify"),
                             ("contact/rigid_tool_contact", "contact/tool_contact_verify")):
            self.assertEqual(self.order(f"include/crossbeam/{header}.hpp")[0], test)

    def test_an_edited_test_comes_first(self):
        self.assertEqual(self.order("verify/law/shear_verify.cpp")[0], "law/shear_verify")

    def test_all_folders_of_the_library_are_known(self):
        folders = {path.name for path in (quick.INCLUDE / "crossbeam").iterdir() if path.is_dir()}
        self.assertEqual(folders - set(quick.NEAR), set())

    def test_dependencies(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "a.d"
            file.write_text(f"a.o: {quick.ROOT}/verify/a\\ b.cpp \\\n /usr/include/math.h \\\n "
                            f"{quick.ROOT}/include/x.hpp \\\n {quick.BUILD}/pch.hxx\n",
                            encoding="utf-8")
            self.assertEqual(quick.read_depends(file),
                             [quick.ROOT / "verify/a b.cpp", quick.ROOT / "include/x.hpp"])

    def test_what_does_not_fit_is_left_out(self):
        ordered = quick.units()[:4]
        seconds = {ordered[1].name: 1000.0}
        verdicts = {ordered[0]: "passed", ordered[2]: "failed", ordered[3]: "passed"}
        with mock.patch.object(quick, "judge",
                               side_effect=lambda unit, _: (verdicts[unit], "why", 3.0)), \
                contextlib.redirect_stdout(io.StringIO()) as said:
            passed, failed, left = quick.run_units(ordered, time.monotonic() + 100, seconds)
        self.assertEqual((passed, failed, left),
                         ([ordered[0], ordered[3]], [ordered[2]], [ordered[1]]))
        self.assertIn(f"FAILED {ordered[2].folder}/{ordered[2].source.name}\nwhy", said.getvalue())
        self.assertEqual(seconds[ordered[0].name], 3.0)


if __name__ == "__main__":
    unittest.main()
