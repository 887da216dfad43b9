"""Tests of fuzz.py: python3 fuzz_test.py"""

import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
import fuzz  # noqa: E402

HEALTHY = """#2 INITED cov: 12 ft: 13
#99 NEW    cov: 345 ft: 400 corp: 3/40b
Done 12345 runs in 11 second(s)
stat::number_of_executed_units: 12345
stat::average_exec_per_sec:     1122
"""


class Fuzz(unittest.TestCase):
    def test_numbers_of_a_log(self):
        self.assertEqual(fuzz.result_of(HEALTHY, 10, 0),
                         {"runs": 12345, "seconds": 10, "exec_per_s": 1122, "findings": 0,
                          "coverage": 345})

    def test_files_are_findings(self):
        self.assertEqual(fuzz.result_of(HEALTHY, 10, 3)["findings"], 3)

    def test_an_early_end_is_a_finding(self):
        for log in ("", HEALTHY.replace("Done", "ERROR: AddressSanitizer")):
            self.assertEqual(fuzz.result_of(log, 10, 0)["findings"], 1)

    def test_measurement_fails_with_a_finding(self):
        for findings in (0, 1):
            line = fuzz.measurement("scene", fuzz.result_of(HEALTHY, 10, findings))
            self.assertEqual((line["id"], line["pass"]), ("V-STRESS-10", findings == 0))

    def test_dictionary_of_the_scenes(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "a.toml"
            scene.write_text("[mesh]\nsize = 5\n  speed= 1\n# no = 1\n", encoding="utf-8")
            self.assertEqual(fuzz.names_of([scene]), '"size"\n"speed"\n')

    def test_seconds(self):
        self.assertEqual(fuzz.positive("20"), 20)
        for text in ("0", "-1", "1.5", "", "x"):
            with self.assertRaises(fuzz.argparse.ArgumentTypeError):
                fuzz.positive(text)


if __name__ == "__main__":
    unittest.main()
