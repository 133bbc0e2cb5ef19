"""`vpslam bench --suite ablation`: what it runs, how it goes on, and what it calls worse. Stand-ins
take the place of the processes: what they write follows from the preset that they are told."""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(SOURCE / "scripts"))
from vpslam_tools.benchmark import comparison  # noqa: E402
from vpslam_tools.suites import ablation  # noqa: E402

TRACKING = ("frame,timestamp,state,inliers,decode_ms,transport_ms,features_ms,lines_ms,vps_ms,"
            "wait_for_lines_ms,initial_pose_ms,rotation_ms,translation_ms,local_map_ms,total_ms\n")
# The default is off by FAKE_ERROR_M at every other frame, and lost for the last FAKE_LOST frames.
FAKE = f"""#!/usr/bin/python3
import json, os, pathlib, sys, time
def option(flag): return sys.argv[sys.argv.index(flag) + 1]
def path(error, frames): return "".join(
    f"{{i / 10:.1f}} {{i + error * (i % 2)}} {{i * i / 10}} 0 0 0 0 1\\n" for i in range(frames))
name = os.path.basename(sys.argv[0])
if name == "player":
    with open(os.environ["FAKE_COUNT"], "a") as file: file.write(sys.argv[1] + "\\n")
    time.sleep(float(os.environ.get("FAKE_SECONDS", 0)))
    pathlib.Path(option("--truth")).write_text(path(0, 25))
if name == "recorder":
    out = pathlib.Path(option("--out"))
    is_default = json.loads(option("--options"))["preset"] == "default"
    patience = time.monotonic() + 60
    while not out.joinpath("truth.txt").exists() and time.monotonic() < patience: time.sleep(0.02)
    error = float(os.environ.get("FAKE_ERROR_M", 0)) if is_default else 0
    lost = int(os.environ.get("FAKE_LOST", 0)) if is_default else 0
    out.joinpath("trajectory.txt").write_text(path(error, 25 - lost))
    out.joinpath("frames.csv").write_text({TRACKING!r} + "".join(
        f"{{i}},{{i / 10}},tracking,9,1,1,2,,,5,3,,,4,17\\n" for i in range(25)))
    out.joinpath("keyframes.csv").write_text("keyframe,insertion_ms,feature_culling_ms,"
        "feature_creation_ms,keyframe_culling_ms,local_ba_ms,total_ms\\n0,1,1,1,1,1,6\\n")
    out.joinpath("summary.json").write_text('{{"frames": {{"in": 25, "dropped": 0}}, '
        '"cpu_ms_per_frame": {{"frontend": 9.5, "total": 30.25}}, "commit": "abc"}}')
"""
PROGRAMS = ("player", "vpdetector", "frontend", "backend", "recorder")


class AblationTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="vpslam-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        (self.folder / "bin").mkdir()
        (self.folder / "runtime").mkdir(mode=0o700)
        for name in PROGRAMS:
            (self.folder / "bin" / name).write_text(FAKE)
            (self.folder / "bin" / name).chmod(0o755)
        (self.folder / "data" / "car_park").mkdir(parents=True)
        (self.folder / "data" / "car_park" / "rgb.txt").write_text("0.0 a\n0.1 b\n")
        self.count = self.folder / "count"

    def start(self, *arguments, **environment):
        self.count.write_text("")
        return subprocess.Popen(
            ["/usr/bin/python3", "-I", str(SOURCE / "scripts" / "vpslam_tools"), "bench", "--suite",
             "ablation", "--data", "data", "--out", "out", *arguments], cwd=self.folder, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
            env=dict(os.environ, VPSLAM_BIN_DIR=str(self.folder / "bin"),
                     XDG_RUNTIME_DIR=str(self.folder / "runtime"), FAKE_COUNT=str(self.count),
                     **environment))

    def bench(self, *arguments, **environment):
        process = self.start("--sequence", "car_park", *arguments, **environment)
        output, _ = process.communicate(timeout=300)
        return process.returncode, output, self.runs_begun()

    def runs_begun(self):
        return len(self.count.read_text().splitlines())


class Command(AblationTest):
    def test_table_and_going_on(self):
        variants = len(ablation.VARIANTS)
        status, output, count = self.bench("--seeds", "2")
        self.assertEqual((status, count), (0, 2 * variants), output)
        for variant in ablation.VARIANTS:
            self.assertRegex(output, rf"\| {variant.replace('+', '[+]')} \| 0.0000 / 0.0000 \|.*"
                                     r"\| 1.000 / 1.000 \| 11.0 \| 9.5 \| 30.2 \|")
        self.assertRegex(output, r"\| car_park \| 25 \| 0.0000 \| 0.0000 \|.*\| yes \|")
        self.assertEqual((self.folder / "out" / "results.md").read_text().strip(),
                         output[output.index("# Ablation"):output.index("\nresults  ")].strip())
        # Of the programs' settings: each variant is run as what it is called.
        for variant, words in ablation.VARIANTS.items():
            run = json.loads((self.folder / "out" / ablation.slug(variant) / "runs" / "car_park"
                              / "lockstep-seed2" / "bench.json").read_text())
            self.assertEqual(run["variant"], variant)
            self.assertIn(" ".join(words), " ".join(run["key"]["command"]))
        # One is cut off: it alone is run again.
        cut = self.folder / "out" / "paper" / "runs" / "car_park" / "lockstep-seed1" / "bench.json"
        cut.write_text(cut.read_text()[:50])
        self.assertEqual(self.bench("--seeds", "2")[::2], (0, 1))

    def test_a_default_that_is_worse_is_told(self):
        status, output, _ = self.bench(FAKE_ERROR_M="0.1")
        self.assertEqual(status, 0, output)
        self.assertIn("| **no: ATE** |", output)
        shutil.rmtree(self.folder / "out")
        status, output, _ = self.bench(FAKE_LOST="3")
        self.assertIn("| car_park | 22 | 0.0000 | 0.0000 |", output)
        self.assertIn("| **no: coverage** |", output)

    def test_what_is_interrupted_is_run_again(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            shutil.rmtree(self.folder / "out", ignore_errors=True)
            process = self.start("--sequence", "car_park", FAKE_SECONDS="30")
            deadline = time.monotonic() + 60
            while self.runs_begun() == 0 and time.monotonic() < deadline:
                time.sleep(0.05)
            process.send_signal(number)
            output, _ = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 130, output)
            self.assertEqual(self.runs_begun(), 1)
            self.assertEqual(list((self.folder / "out").glob("**/bench.json")), [])
        status, output, count = self.bench()
        self.assertEqual((status, count), (0, len(ablation.VARIANTS)), output)

    def test_chooses_presets_itself(self):
        for words in (["--preset", "points"], ["--lines", "off"], ["--detectors", "2"],
                      ["--pace", "realtime"]):
            status, output, count = self.bench(*words)
            self.assertEqual((status, count), (1, 0), output)
            self.assertIn("leave them out", output)


class Judgement(unittest.TestCase):
    def pair(self, reference_ate_m, ate_m, reference_coverage=1.0, coverage=1.0):
        return {"reference_ate_m": reference_ate_m, "ate_m": ate_m,
                "reference_coverage": reference_coverage, "coverage": coverage}

    def worse(self, *pairs):
        return comparison.judge(pairs)["worse"]

    def test_two_millimetres_are_allowed(self):
        self.assertEqual(self.worse(self.pair(0.010, 0.0119)), [])
        self.assertEqual(self.worse(self.pair(0.010, 0.0121)), ["ATE"])

    def test_five_per_cent_are_allowed(self):
        self.assertEqual(self.worse(self.pair(1.0, 1.049)), [])
        self.assertEqual(self.worse(self.pair(1.0, 1.051)), ["ATE"])

    def test_the_spread_over_the_seeds_is_allowed(self):
        self.assertEqual(self.worse(self.pair(0.10, 0.119), self.pair(0.12, 0.12)), [])
        self.assertEqual(self.worse(self.pair(0.10, 0.121), self.pair(0.12, 0.12)), ["ATE"])

    def test_each_seed_counts(self):
        self.assertEqual(self.worse(*[self.pair(0.1, 0.05)] * 4, self.pair(0.1, 0.2)), ["ATE"])

    def test_coverage(self):
        self.assertEqual(self.worse(self.pair(0.1, 0.1, 0.90, 0.895)), [])
        self.assertEqual(self.worse(self.pair(0.1, 0.1, 0.90, 0.885)), ["coverage"])

    def test_where_points_have_no_pose_there_is_nothing_to_be_worse_than(self):
        self.assertEqual(self.worse(self.pair(None, None, 0.0, 0.9)), [])

    def test_a_default_without_any_pose_is_worse(self):
        self.assertEqual(self.worse(self.pair(None, None, 0.9, 0.0)), ["coverage"])


class CommonFrames(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="vpslam-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def results(self, name, estimate):
        folder = self.folder / name
        folder.mkdir()
        truth = [(i / 10, i, i * i / 10) for i in range(20)]
        for file, rows in (("truth.txt", truth), ("trajectory.txt", estimate(truth))):
            (folder / file).write_text("".join(f"{t:.3f} {x} {y} 0 0 0 0 1\n" for t, x, y in rows))
        return folder

    def test_errors_where_the_other_is_lost_do_not_count(self):
        def stray(truth):
            return [(t, x + 5 * (t > 1), y) for t, x, y in truth]
        frames, short_m, long_m = comparison.ates_over_common_frames(
            self.results("short", lambda truth: truth[:11]), self.results("long", stray))
        self.assertEqual(frames, 11)
        self.assertAlmostEqual(short_m, 0)
        self.assertAlmostEqual(long_m, 0)

    def test_nothing_in_common(self):
        frames, *ates = comparison.ates_over_common_frames(
            self.results("start", lambda truth: truth[:10]),
            self.results("end", lambda truth: truth[10:]))
        self.assertEqual((frames, ates), (0, [None, None]))
        frames, *ates = comparison.ates_over_common_frames(
            self.folder / "start", self.results("none", lambda truth: []))
        self.assertEqual((frames, ates), (0, [None, None]))


if __name__ == "__main__":
    unittest.main()
