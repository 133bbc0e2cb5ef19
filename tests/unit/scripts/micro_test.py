"""`vpslam bench --suite micro`: what it takes from Google Benchmark, and its ratios."""

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "vpslam_tools"


def entry(name, cpu_ms, real_ms, run_type="iteration", **more):
    return dict({"run_name": name, "run_type": run_type, "cpu_time": cpu_ms, "real_time": real_ms,
                 "time_unit": "ms"}, **more)


class Micro(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="vpslam-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        (self.folder / "bin").mkdir()
        self.program = self.folder / "bin" / "micro_bench"
        self.measured([entry("A/1", 2.0, 3.0), entry("A/1", 2.5, 3.0), entry("A/1", 1, 1, "aggregate"),
                       entry("B/real_time", 1.0, 4.0),
                       entry("C", 0, 0, error_occurred=True)])

    def measured(self, entries):
        output = json.dumps({"benchmarks": entries})
        self.program.write_text(f"#!/bin/sh\ncat <<'END'\n{output}\nEND\n")
        self.program.chmod(0o755)

    def bench(self, *arguments):
        done = subprocess.run(
            ["/usr/bin/python3", "-I", str(TOOLS), "bench", "--suite", "micro", "--out", "out",
             "--baseline", "base.json", *arguments], cwd=self.folder, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            env=dict(os.environ, VPSLAM_BIN_DIR=str(self.folder / "bin")))
        return done.returncode, done.stdout

    def test_ratios_to_a_stored_baseline(self):
        status, output = self.bench("--store-baseline")
        self.assertEqual(status, 0, output)
        self.assertIn("| A/1 | 2000.0 | - | - |", output)
        self.assertIn("| B/real_time | 4000.0 | - | - |", output)
        self.assertNotIn("| C |", output)
        self.measured([entry("A/1", 3.0, 3.0), entry("B/real_time", 1.0, 2.0)])
        status, output = self.bench()
        self.assertIn("| A/1 | 3000.0 | 2000.0 | **1.50** |", output)
        self.assertIn("| B/real_time | 2000.0 | 4000.0 | 0.50 |", output)
        self.assertIn("the baseline's processor: the same", output)
        self.assertEqual((self.folder / "out" / "micro.md").read_text(), output)

    def test_a_damaged_baseline(self):
        (self.folder / "base.json").write_text("{}")
        status, output = self.bench()
        self.assertEqual(status, 1)
        self.assertIn("base.json: is no baseline", output)
        self.assertNotIn("Traceback", output)

    def test_missing_program(self):
        self.program.unlink()
        status, output = self.bench()
        self.assertEqual(status, 1)
        self.assertIn("libbenchmark-dev", output)


if __name__ == "__main__":
    unittest.main()
