"""`vpslam bench` finds its suites, and calls their programs with what they were given."""

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "vpslam_tools"
FAKE = """#!/bin/sh
echo "$(basename "$0") $*"
echo "a table" > "$4/york.md"
echo '[{"lines": "lsd", "aa_3_5_10": [1, 2, 3]}]' > "$4/york.json"
exit ${FAKE_STATUS:-0}
"""


class Bench(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="vpslam-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        (self.folder / "bin").mkdir()
        (self.folder / "data").mkdir()
        for name in ("york_bench", "detector_bench"):
            (self.folder / "bin" / name).write_text(FAKE)
            (self.folder / "bin" / name).chmod(0o755)

    def bench(self, *arguments, **environment):
        done = subprocess.run(
            ["/usr/bin/python3", "-I", str(TOOLS), "bench", *arguments], cwd=self.folder, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            env=dict(os.environ, VPSLAM_BIN_DIR=str(self.folder / "bin"),
                     VPSLAM_SHARED_DATA=str(self.folder / "shared"), **environment))
        return done.returncode, done.stdout

    def test_york(self):
        status, output = self.bench("--suite", "york", "--data", "data", "--out", "a/b",
                                    "--annotated")
        self.assertEqual(status, 0, output)
        out = self.folder / "a" / "b"
        self.assertIn(f"york_bench --data data --out {out} --annotated\n", output)
        results = json.loads((out / "results.json").read_text())
        self.assertEqual(results["rows"][0]["aa_3_5_10"], [1, 2, 3])
        for expected in ("a table", "--suite york", "J-Linkage"):
            self.assertIn(expected, (out / "results.md").read_text())

    def test_the_status_is_passed_on(self):
        status, _ = self.bench("--suite", "york", "--data", "data", "--out", "o", FAKE_STATUS="1")
        self.assertEqual(status, 1)

    def test_bad_arguments(self):
        for arguments, expected, code in (
                (["--suite", "york", "--out", "o"], "shared/york_urban_train: no such folder", 1),
                (["--suite", "york", "--data", "none", "--out", "o"], "none: no such folder", 1),
                (["--suite", "york", "--data", "data", "--out", "/proc/o"], "cannot be made", 1),
                (["--suite", "yorck", "--out", "o"], "invalid choice", 2),
                (["--out", "o"], "required", 2)):
            with self.subTest(arguments):
                status, output = self.bench(*arguments)
                self.assertEqual(status, code, output)
                self.assertIn(expected, output)
                self.assertNotIn("Traceback", output)

    def test_missing_program(self):
        (self.folder / "bin" / "york_bench").unlink()
        status, output = self.bench("--suite", "york", "--data", "data", "--out", "o")
        self.assertEqual(status, 1)
        self.assertIn("cannot be started", output)


if __name__ == "__main__":
    unittest.main()
