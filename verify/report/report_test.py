"""Tests of report.py: python3 report_test.py"""

import contextlib
import io
import json
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
import report  # noqa: E402

TABLE = """# Claims

## First area

| ID | statement | test file | independent source | tolerance and why |
| --- | --- | --- | --- | --- |
| V-ONE-01 | The `first` is right | `one/a_verify.cpp` | paper and pencil | 1e-12: rounding |
| V-ONE-02 | Yes or no | `one/a_verify.cpp` | list | a count: 0 |

## Second area

| ID | statement | test file | independent source | tolerance and why |
| --- | --- | --- | --- | --- |
| V-TWO-01 | Order two | `two/b_verify.cpp` | rates | 0.1: next term |
"""


def measurement(claim, measured, tolerance, note="of it", bound="upper", passes=None):
    if passes is None:
        passes = measured <= tolerance if bound == "upper" else measured >= tolerance
    return {"kind": "measurement", "id": claim, "measured": measured, "tolerance": tolerance,
            "bound": bound, "pass": passes, "note": note}


def curve(x, y, style="line", name="a curve"):
    return {"name": name, "style": style, "x": x, "y": y}


def plot(claim, title="Slope", **changes):
    x = [1, 0.5, 0.25, 0.125]
    return {"kind": "plot", "id": claim, "title": title, "caption": "Parallel to the guide.",
            "style": "curves", "x": "step [mm]", "y": "error [kN]", "log_x": True, "log_y": True,
            "curves": [curve(x, [v * v for v in x]), curve(x, x, "guide", "order 1"),
                       curve(x, [0.9, None, 0.04, 0], "points", "with gaps")], **changes}


MAP = {"kind": "map", "id": "V-TWO-01", "title": "Field", "caption": "Grey is slack.", "x": "a [%]",
       "y": "b [%]", "z": "force [kN]", "at_x": [0, 1, 2], "at_y": [0, 1],
       "values": [[1, None, 3], [4, 5, 6]]}
BARS = plot("V-TWO-01", "Sweeps", style="bars", log_x=False, x="cost [$], $x^2$",
            curves=[curve([0, 1, 2], [10, 0, 1000])])
PICTURES = [plot("V-ONE-01"), plot("V-TWO-01"), MAP, BARS]
HEALTHY = [measurement("V-ONE-01", 5e-13, 1e-12, "10 sweeps"),
           measurement("V-ONE-01", 2e-15, 1e-12, "9 sweeps"),
           measurement("V-TWO-01", 3.0, 1.0, "seen <b>&amp;", "lower")]
TESTS = {"V-ONE-01 first": "run", "V-ONE-02 second": "run", "V-TWO-01 third": "run",
         "packs add": "run"}
MUTATION = {"score": 0.9999, "mutants": 20003, "killed": 19998, "not_applicable": 3, "seconds": 9,
            "per_file": {"cell/yarn.hpp": {"mutants": 20003, "killed": 19998}},
            "survivors": [{"file": "cell/yarn.hpp", "line": 7, "kind": "sign", "before": "a + b",
                           "after": "a - b", "explanation": "b is zero"}]}


class ReportTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.out = self.folder / "out"

    def file(self, name, text):
        path = self.folder / name
        path.write_text(text if isinstance(text, str) else json.dumps(text), encoding="utf-8")
        return str(path)

    def run_report(self, log, *arguments):
        """The exit status; what it said and wrote is kept."""
        text = log if isinstance(log, str) else "".join(json.dumps(line) + "\n" for line in log)
        self.said = io.StringIO()
        with contextlib.redirect_stdout(self.said), contextlib.redirect_stderr(self.said):
            status = report.main(["--log", self.file("log.jsonl", text), "--out", str(self.out),
                                  *arguments])
        self.said = self.said.getvalue()
        if (self.out / "report.json").exists():
            self.json = json.loads((self.out / "report.json").read_text(encoding="utf-8"))
            self.html = (self.out / "report.html").read_text(encoding="utf-8")
            self.claim = {claim["id"]: claim for claim in self.json["claims"]}
        return status

    def run_suite(self, log, tests=None, *arguments):
        """As `./run verify` does: with a table and JUnit's file."""
        cases = "".join(f'<testcase name="{name}" time="0.5" status="{status}"/>'
                        for name, status in (TESTS if tests is None else tests).items())
        return self.run_report(
            log, "--claims", self.file("claims.md", TABLE), "--junit",
            self.file("tests.xml", f'<testsuite time="7">{cases}</testsuite>'), *arguments)

    def assert_refused(self, log, *reasons):
        self.assertEqual(self.run_suite(log), 2)
        for reason in reasons:
            self.assertIn(reason, self.said)
        self.assertEqual(list(self.out.glob("*")) if self.out.exists() else [], [])

    def test_all_hold(self):
        self.assertEqual(self.run_suite(HEALTHY), 0)
        self.assertIn("3 of 3 claims hold; 3 comparisons", self.said)
        self.assertEqual(self.json["summary"], {"claims": 3, "held": 3, "not_held": 0,
                                                "not_run": 0, "comparisons": 3})
        self.assertEqual([c["id"] for c in self.json["claims"]],
                         ["V-ONE-01", "V-ONE-02", "V-TWO-01"])
        one = self.claim["V-ONE-01"]
        self.assertEqual((one["area"], one["independent_source"], one["tests"], one["pass"]),
                         ("First area", "paper and pencil", 1, True))
        # The number of a claim is the one closest to its bound; nine comes before ten.
        self.assertEqual((one["measured"], one["tolerance"], one["bound"]), (5e-13, 1e-12, "upper"))
        self.assertEqual([c["note"] for c in one["comparisons"]], ["9 sweeps", "10 sweeps"])
        self.assertIsNone(self.json["mutation"]["score"])
        self.assertEqual(self.json["seconds"], 7)
        self.assertEqual(self.json["other_tests"], {"run": 1, "failed": []})
        self.assertIn("3 of 3 claims hold", self.html)
        self.assertNotIn("does not hold", self.html)
        self.assertIn("ctest --test-dir build/verify -R V-TWO-01 --output-on-failure", self.html)

    def test_page_stands_alone(self):
        self.run_suite(HEALTHY + PICTURES)
        for claim in self.claim:
            self.assertIn(f'id="{claim}"', self.html)
        self.assertEqual(re.findall(r"(?i)https?:|//[a-z]+\.[a-z]|@import|<link|\bsrc=", self.html),
                         [])
        # All ids of all pictures differ, and every reference finds its own.
        ids = re.findall(r'\bid="([^"]+)"', self.html)
        self.assertEqual(len(ids), len(set(ids)))
        for place in re.findall(r'(?:href="#|url\(#)([^")]+)', self.html):
            self.assertIn(place, ids)
        self.assertEqual(self.html.count("<svg"), 5)  # four pictures and the margins
        self.assertIn("seen &lt;b&gt;&amp;amp;", self.html)
        # Text remains text, as it is.
        self.assertIn("step [mm]</text>", self.html)
        self.assertIn("cost [$], $x^2$</text>", self.html)

    def test_number_beyond_its_tolerance(self):
        log = HEALTHY + [measurement("V-TWO-01", 0.5, 0.1, "off 2")]
        self.assertEqual(self.run_suite(log), 1)
        self.assertIn("NOT HELD V-TWO-01: off 2: 0.5 is not ≤ 0.1", self.said)
        self.assertFalse(self.claim["V-TWO-01"]["pass"])
        self.assertEqual(self.claim["V-TWO-01"]["measured"], 0.5)
        self.assertTrue(self.claim["V-ONE-01"]["pass"])
        self.assertIn("✗ 2 of 3 claims hold", self.html)
        self.assertIn('<a href="#V-TWO-01"><b>V-TWO-01</b></a>', self.html)

    def test_failed_test(self):
        self.assertEqual(self.run_suite(HEALTHY, {**TESTS, "V-ONE-02 second": "fail"}), 1)
        self.assertFalse(self.claim["V-ONE-02"]["pass"])

    def test_failed_test_without_a_claim(self):
        self.assertEqual(self.run_suite(HEALTHY, {**TESTS, "packs add": "fail"}), 1)
        self.assertIn("FAILED packs add", self.said)
        self.assertEqual(self.json["other_tests"]["failed"], ["packs add"])
        self.assertIn('class="verdict broken"', self.html)

    def test_claim_without_test(self):
        tests = {name: status for name, status in TESTS.items() if "TWO" not in name}
        self.assertEqual(self.run_suite(HEALTHY, tests), 1)
        self.assertEqual(self.claim["V-TWO-01"]["faults"], ["no test carries this ID"])

    def test_claim_left_to_long_tests(self):
        tests = {name: status for name, status in TESTS.items() if "TWO" not in name}
        log = [line for line in HEALTHY if line["id"] != "V-TWO-01"]
        every = {"tests": [{"name": name} for name in [*tests, "V-TWO-01 third (long)"]]}
        status = self.run_suite(log, tests, "--tests", self.file("all.json", every))
        self.assertEqual(status, 0)
        self.assertIsNone(self.claim["V-TWO-01"]["pass"])
        self.assertEqual(self.json["summary"]["not_run"], 1)
        self.assertIn("1 not run", self.said)
        self.assertEqual(self.json["left_out"], "left out of this run: 1 long test")
        self.assertIn("3 claims hold<span class=\"left\">; left out of this run: 1 long", self.html)

    def test_parts_of_the_run(self):
        parts = [{"name": "fuzzing", "status": "passed", "note": ""},
                 {"name": "mutation run", "status": "left out", "note": "the record is shown"}]
        self.assertEqual(
            self.run_suite(HEALTHY, None, "--parts", self.file("parts.json", parts)), 0)
        self.assertIn("left out of this run: mutation run", self.html)
        parts[0]["status"] = "failed"
        self.assertEqual(
            self.run_suite(HEALTHY, None, "--parts", self.file("parts.json", parts)), 1)
        self.assertIn('class="verdict broken"', self.html)
        self.assertIn("FAILED fuzzing", self.said)
        self.assertEqual(self.run_suite(HEALTHY, None, "--parts", self.file("parts.json", [1])), 2)

    @unittest.skipUnless(shutil.which("ctest"), "needs ctest")
    def test_headline_and_exit_status_agree_with_ctest(self):
        """Tests that pass, fail, skip themselves or have no program, as ctest itself writes them."""
        cases = {
            "passes": ("/bin/sh -c true", "", True),
            "fails": ("/bin/sh -c false", "", False),
            "skips": ('/bin/sh -c "exit 77"', "SKIP_RETURN_CODE 77", True),
            "says so": ('/bin/sh -c "echo skipped"', "SKIP_REGULAR_EXPRESSION skipped", True),
            "is disabled": ("/bin/sh -c false", "DISABLED TRUE", True),
            "has no program": ("/no/such/program", "", False),
        }
        for name, (command, properties, good) in cases.items():
            for claim in ("V-ONE-02 ", ""):
                with self.subTest(name + " " + claim):
                    build = self.folder / "build"
                    build.mkdir(exist_ok=True)
                    tests = [(f"{known} passes", "/bin/sh -c true", "")
                             for known in ("V-ONE-01", "V-ONE-02", "V-TWO-01")]
                    tests.append((claim + name, command, properties))
                    (build / "CTestTestfile.cmake").write_text("".join(
                        f'add_test("{test}" {what})\n' +
                        (f'set_tests_properties("{test}" PROPERTIES {how})\n' if how else "")
                        for test, what, how in tests), encoding="utf-8")
                    junit = self.folder / "ctest.xml"
                    ctest = subprocess.run(
                        ["ctest", "--test-dir", build, "--output-junit", junit],
                        capture_output=True, check=False).returncode
                    status = self.run_report(
                        HEALTHY, "--claims", self.file("claims.md", TABLE), "--junit", str(junit))
                    self.assertEqual((ctest == 0, status == 0), (good, good), self.said)
                    self.assertEqual("✓ 3 of 3 claims hold" in self.html, good)
                    self.assertEqual('class="verdict broken"' in self.html, not good)
                    skipped = good and name != "passes"
                    self.assertEqual("1 test skipped here: " + claim + name in self.html, skipped)

    def test_numbers_that_are_not_finite(self):
        passes = measurement("V-ONE-01", None, 1, "slope of a wrong derivative", "lower", True)
        self.assertEqual(self.run_suite(HEALTHY + [passes]), 0)
        fails = measurement("V-ONE-01", None, 1, "NaN", "upper", False)
        self.assertEqual(self.run_suite(HEALTHY + [fails]), 1)
        self.assertIn("NaN: not finite is not ≤ 1", self.said)

    def test_share_of_the_tolerance(self):
        for measured, tolerance, bound, share in (
                (1, 4, "upper", 0.25), (4, 1, "lower", 0.25), (0, 0, "upper", 0),
                (-1, 0, "upper", 0), (5e-321, 1e-12, "upper", 0), (1, 0, "lower", 0),
                (-4, -1, "upper", 0.25), (2, 1, "upper", 2), (1, 0, "upper", float("inf")),
                (-1, 1, "lower", float("inf"))):
            found = report.used(measurement("V-ONE-01", measured, tolerance, bound=bound))
            self.assertAlmostEqual(found, share, msg=(measured, tolerance, bound))

    def test_bad_lines_leave_nothing_behind(self):
        good = json.dumps(HEALTHY[0]) + "\n"
        self.assert_refused(good + '{"kind": "measure\n', "log.jsonl, line 2")
        self.assert_refused(good + "[1]\n", "line 2", "object")
        self.assert_refused([{"kind": "guess"}], "line 1", "'guess'")
        self.assert_refused([{"kind": "measurement", "id": "V-ONE-01"}], "without measured")
        self.assert_refused([measurement("V-ONE-01", "1", 2, passes=True)], "measured is '1'")
        self.assert_refused([measurement("V-ONE-01", 3, 2, passes=True)], "contradicts")
        self.assert_refused([measurement("V-ONE-01", 3, 2, bound="middle")], "bound is 'middle'")
        self.assert_refused([HEALTHY[0], measurement("V-NO-01", 1, 2)], "line 2",
                            "unknown claim V-NO-01")
        self.assert_refused([plot("V-ONE-01", curves=[curve([1, 2], [1])])], "2 x and 1 y")
        self.assert_refused([plot("V-ONE-01", curves=[curve([1], ["one"])])], "cannot be drawn")
        self.assert_refused([{**MAP, "values": [[1, 2, 3]]}], "rows of at_x")

    def test_bad_files(self):
        def refused(expected, *arguments):
            self.assertEqual(self.run_report(HEALTHY, *arguments), 2)
            self.assertIn(expected, self.said)
            self.assertFalse(self.out.exists())
        refused("cannot read", "--claims", str(self.folder / "nowhere.md"))
        refused("no claims", "--claims", self.file("empty.md", "# Nothing\n"))
        refused("4 columns", "--claims", self.file("four.md", "| V-A-1 | a | b | c |\n"))
        refused("second row", "--claims", self.file("twice.md", "| V-A-1 | a | b | c | d |\n" * 2))
        table = ("--claims", self.file("claims.md", TABLE))
        refused("no JUnit XML", *table, "--junit", self.file("bad.xml", "<testsuite>"))
        refused("no JSON", *table, "--mutation", self.file("bad.json", "{"))
        refused("no score", *table, "--mutation", self.file("scoreless.json", {}))
        self.assertEqual(self.run_report([]), 2)
        self.assertIn("no claims", self.said)

    def test_mutation(self):
        self.run_suite(HEALTHY, None, "--mutation", self.file("mutation.json", MUTATION))
        self.assertEqual(self.json["mutation"]["score"], 0.9999)
        self.assertIn("99.9&#8239;%", self.html)  # not rounded up to all
        for text in ("cell/yarn.hpp:7", "a - b", "b is zero", "19998 of 20000"):
            self.assertIn(text, self.html)

    def test_record_of_a_mutation_run(self):
        record = {**MUTATION, "recorded": True, "date": "2026-04-01", "commit": "0123456789abcdef",
                  "changed": ["crossbeam/cell/yarn.hpp"]}
        self.run_suite(HEALTHY, None, "--mutation", self.file("mutation.json", record))
        for text in ("recorded 2026-04-01, commit 0123456789; 1 header changed since",
                     "<code>crossbeam/cell/yarn.hpp</code>"):
            self.assertIn(text, self.html)
        record["changed"] = []
        self.run_suite(HEALTHY, None, "--mutation", self.file("mutation.json", record))
        self.assertIn("no header changed since", self.html)

    def test_build(self):
        build = {"compiler": "C 1.2", "flags": "-O2 -DX=<y>", "version": "1.2.3", "eigen": "3.4.0"}
        self.run_suite(HEALTHY, None, "--build", self.file("build.json", build))
        self.assertEqual((self.json["compiler"], self.json["version"]), ("C 1.2", "1.2.3"))
        self.assertIn("-O2 -DX=&lt;y&gt;", self.html)

    def test_order_of_the_log_means_nothing(self):
        def pages():
            self.assertEqual(self.run_suite(lines), 0)
            return [text.replace(self.json["date"], "today")
                    for text in (self.html, json.dumps(self.json))]
        lines = HEALTHY + PICTURES[:2]
        first = pages()
        lines.reverse()
        self.assertEqual(first, pages())

    def test_a_users_own_law(self):
        def claim(name, statement="It has a potential"):
            return {"kind": "claim", "id": name, "statement": statement, "source": "Taylor slopes",
                    "tolerance_reason": "next term", "area": "Yarn law"}
        subject = {"kind": "subject", "name": "Toe curve", "stiffness [kN]": 35.4}
        log = [measurement("YARN-2", 1, 2), plot("YARN-1"), claim("YARN-1"), claim("YARN-2"),
               subject, measurement("YARN-1", 1.9, 2), claim("YARN-1")]
        self.assertEqual(self.run_report(log), 0)
        self.assertEqual(list(self.claim), ["YARN-1", "YARN-2"])
        self.assertEqual(self.json["title"], "Verification of Toe curve")
        self.assertIn("stiffness [kN]", self.html)
        self.assertNotIn("ctest", self.html)
        self.assertEqual(self.run_report(log, "--repeat", "./mine -c {id}", "--title", "Mine"), 0)
        self.assertIn("./mine -c YARN-2", self.html)
        self.assertEqual(self.json["title"], "Mine")

        self.assertEqual(self.run_report(log + [measurement("YARN-1", 3, 2)]), 1)
        self.assertEqual(self.run_report(log + [claim("YARN-3")]), 1)
        self.assertIn("NOT HELD YARN-3: nothing was measured", self.said)
        self.assertEqual(self.run_report(log + [claim("YARN-1", "Something else")]), 2)
        self.assertIn("line 8: another claim than before under YARN-1", self.said)


if __name__ == "__main__":
    unittest.main()
