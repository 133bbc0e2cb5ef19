"""`vpslam bench` on sequences: what it finds, runs again, and makes of the results. Stand-ins take
the place of the processes."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(SOURCE / "scripts"))
from vpslam_tools import sources  # noqa: E402
from vpslam_tools.benchmark import catalogue, discovery, runs, scores, tables, timing  # noqa: E402
from vpslam_tools.errors import UserError  # noqa: E402

TRACKING = ("frame,timestamp,state,inliers,decode_ms,transport_ms,features_ms,lines_ms,vps_ms,"
            "wait_for_lines_ms,initial_pose_ms,rotation_ms,translation_ms,local_map_ms,total_ms\n")
MAPPING = ("keyframe,frame,timestamp,insertion_ms,feature_culling_ms,feature_creation_ms,"
           "keyframe_culling_ms,local_ba_ms,total_ms\n")
JPEG = bytes.fromhex(  # 8 x 8 px of grey
    "ffd8ffe000104a46494600010100000100010000ffdb004300" + 64 * "ff" + "ffc0000b080008000801011100"
    "ffc40014000100000000000000000000000000000000ffc40014100100000000000000000000000000000000"
    "ffda0008010100003f003fffd9")
# The player writes the truth, the recorder the rest; both count how often they are called.
FAKE = f"""#!/usr/bin/python3
import os, pathlib, sys, time
def option(flag): return sys.argv[sys.argv.index(flag) + 1]
name = os.path.basename(sys.argv[0])
poses = "".join(f"{{i / 10:.1f}} {{i}} {{i * i / 10}} 0 0 0 0 1\\n" for i in range(20))
if name == "player":
    with open(os.environ["FAKE_COUNT"], "a") as file: file.write(sys.argv[1] + "\\n")
    if os.environ.get("FAKE_FAILS") in sys.argv[1].split("/"): sys.exit("the lens is dirty")
    pathlib.Path(option("--truth")).write_text(poses)
if name == "recorder":
    out = pathlib.Path(option("--out"))
    patience = time.monotonic() + 60
    while not out.joinpath("truth.txt").exists() and time.monotonic() < patience: time.sleep(0.02)
    out.joinpath("trajectory.txt").write_text(poses)
    out.joinpath("frames.csv").write_text({TRACKING!r} + "".join(
        f"{{i}},{{i / 10}},tracking,9,1,1,2,,,,3,,,4,11\\n" for i in range(25)))
    out.joinpath("keyframes.csv").write_text({MAPPING!r} + "0,0,0.0,1,1,1,1,1,6\\n")
    out.joinpath("map.ply").write_text("ply\\nformat ascii 1.0\\nelement vertex 1\\nend_header\\n"
                                       "1 2 3 160 160 160\\n")
    out.joinpath("preview.jpg").write_bytes({JPEG!r})
    out.joinpath("summary.json").write_text('{{"frames": {{"in": 25, "dropped": 0}}, '
                                            '"commit": "abc"}}')
"""


class BenchTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="vpslam-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        (self.folder / "bin").mkdir()
        (self.folder / "runtime").mkdir(mode=0o700)
        for name in ("player", "vpdetector", "frontend", "backend", "recorder"):
            (self.folder / "bin" / name).write_text(FAKE)
            (self.folder / "bin" / name).chmod(0o755)
        self.count = self.folder / "count"

    def sequence(self, *names):
        for name in names:
            (self.folder / "data" / name).mkdir(parents=True)
            (self.folder / "data" / name / "rgb.txt").write_text("# x\n0.0 a\n0.1 b\n")

    def bench(self, *arguments, **environment):
        self.count.write_text("")
        done = subprocess.run(
            ["/usr/bin/python3", "-I", str(SOURCE / "scripts" / "vpslam_tools"), "bench",
             *arguments], cwd=self.folder, text=True, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env=dict(os.environ, VPSLAM_BIN_DIR=str(self.folder / "bin"),
                     XDG_RUNTIME_DIR=str(self.folder / "runtime"), FAKE_COUNT=str(self.count),
                     **environment))
        return done.returncode, done.stdout, len(self.count.read_text().splitlines())


class Command(BenchTest):
    def test_results_tables_and_pictures(self):
        self.sequence("car_park", "mine")
        status, output, count = self.bench("--suite", "shared", "--data", "data", "--out", "out",
                                           "--seeds", "2", "--pace", "lockstep")
        self.assertEqual((status, count), (0, 4), output)
        self.assertIn("missing  red_kitchen", output)
        self.assertIn("| car_park | 25 | 0.0000 / 0.0000 | 0.800 / 0.800 |",
                      output.replace(" \\*", ""))
        self.assertIn("nothing left", output)
        results = json.loads((self.folder / "out" / "results.json").read_text())
        self.assertEqual([each["name"] for each in results["sequences"]], ["car_park", "mine"])
        self.assertEqual(len(results["runs"]), 4)
        for name in ("trajectory", "map", "frame", "times"):
            for ending in ("png", "svg"):
                self.assertTrue((self.folder / "out" / "pictures" / "mine" / "lockstep"
                                 / f"{name}.{ending}").is_file(), name)
        self.assertIn((self.folder / "out" / "results.md").read_text(), output)

    def test_goes_on_where_it_stopped(self):
        self.sequence("car_park", "red_kitchen")
        options = ("--suite", "shared", "--data", "data", "--out", "out", "--no-pictures",
                   "--pace", "lockstep")
        self.assertEqual(self.bench(*options)[2], 2)
        status, output, count = self.bench(*options)
        self.assertEqual((status, count), (0, 0), output)
        self.assertIn("car_park, lockstep, seed 1: done before", output)
        # One that was cut off, other options, other programs.
        run = self.folder / "out" / "runs" / "car_park" / "lockstep-seed1" / "bench.json"
        run.write_text(run.read_text()[:100])
        self.assertEqual(self.bench(*options)[2], 1)
        self.assertEqual(self.bench(*options, "--frames", "7")[2], 2)
        with open(self.folder / "bin" / "backend", "a") as file:
            file.write("# another\n")
        self.assertEqual(self.bench(*options, "--frames", "7")[2], 2)
        # Files that are still of the same name.
        (self.folder / "data" / "car_park" / "camera.yaml").write_text("another: one\n")
        self.assertEqual(self.bench(*options, "--frames", "7")[2], 1)
        (self.folder / "data" / "car_park" / "groundtruth.txt").write_text("0 0 0 0 0 0 0 1\n")
        self.assertEqual(self.bench(*options, "--frames", "7")[2], 1)
        settings = self.folder / "settings.yaml"
        for text, runs_again in (("frontend: {}\n", 2), ("frontend: {}\n", 0), ("backend: {}\n", 2)):
            settings.write_text(text)
            self.assertEqual(self.bench(*options, "--config", str(settings))[2], runs_again)

    def test_paces_side_by_side(self):
        self.sequence("car_park")
        status, output, count = self.bench("--suite", "shared", "--data", "data", "--out", "out",
                                           "--no-pictures")
        self.assertEqual((status, count), (0, 2), output)
        self.assertIn("| lockstep: ATE (m) | coverage | rotation (deg) | realtime: ATE (m) |", output)
        for pace in ("lockstep", "realtime"):
            self.assertIn(f"| car_park | {pace} | 0 | 0 |", output)

    def test_a_failure_is_told_and_tried_again(self):
        self.sequence("car_park", "red_kitchen")
        options = ("--suite", "shared", "--data", "data", "--out", "out", "--no-pictures",
                   "--pace", "lockstep")
        status, output, count = self.bench(*options, FAKE_FAILS="car_park")
        self.assertEqual((status, count), (1, 2), output)
        self.assertIn("- car_park: failed:", output)
        self.assertIn("| red_kitchen | 25 | 0.0000", output)
        self.assertNotIn("Traceback", output)
        self.assertEqual(self.bench(*options)[::2], (0, 1))

    def test_a_folder_of_tum_alone(self):
        self.sequence("rgbd_dataset_freiburg2_desk")
        status, output, _ = self.bench(
            "--suite", "tum", "--data", "data/rgbd_dataset_freiburg2_desk", "--out", "out")
        self.assertEqual(status, 0, output)
        self.assertNotIn("missing", output)
        self.assertRegex(output, r"\| fr2/desk \|.*\| 0.012 \| \*\*0.009\*\* \| 0.012 \| .0088 \|")

    def test_bad_arguments(self):
        self.sequence("car_park")
        for arguments, expected in (
                (["--data", "none"], "none: no such folder"),
                (["--data", "runtime"], "none of the suite's sequences is there"),
                (["--data", "data", "--sequence", "moon"], "--sequence moon"),
                (["--data", "data", "--pace", "never"], "refuses the options")):
            with self.subTest(arguments):
                status, output, _ = self.bench("--suite", "shared", "--out", "out", *arguments)
                self.assertEqual(status, 1, output)
                self.assertIn(expected, output)
                self.assertNotIn("Traceback", output)


class Parts(BenchTest):
    def test_published_calibration_where_there_is_none(self):
        self.sequence("rgbd_dataset_freiburg3_x", "plain")
        data = self.folder / "data"
        of_tum = str(data / "rgbd_dataset_freiburg3_x")
        self.assertTrue(sources.published_camera(of_tum).endswith("tum3.yaml"))
        for other in (str(data / "plain"), "sim:freiburg3"):
            self.assertIsNone(sources.published_camera(other))
        (data / "rgbd_dataset_freiburg3_x" / "camera.yaml").touch()
        self.assertIsNone(sources.published_camera(of_tum))

    def test_layouts_and_frames(self):
        data = self.folder / "layouts"
        for folder, file, text in (("tum", "rgb.txt", "# c\n1 a\n2 b\n"),
                                   ("euroc", "mav0/cam0/data.csv", "#t,f\n1,a\n2,b\n"),
                                   ("kitti", "times.txt", "0\n1\n")):
            (data / folder / file).parent.mkdir(parents=True)
            (data / folder / file).write_text(text)
        (data / "kitti" / "image_0").mkdir()
        (data / "icl" / "rgb").mkdir(parents=True)
        for name in ("livingRoom0n.gt.freiburg", "rgb/0.png", "rgb/1.png"):
            (data / "icl" / name).touch()
        (data / "nothing").mkdir()
        found, missing = discovery.discover([catalogue.Sequence("t", "tum"),
                                             catalogue.Sequence("u", "u")], data)
        self.assertEqual([(each.sequence.name, each.frames) for each in found],
                         [("t", 2), ("euroc", 2), ("icl", 2), ("kitti", 2)])
        self.assertEqual([each.name for each in missing], ["u"])
        with self.assertRaises(UserError):
            discovery.discover([], data / "absent")

    def test_median_and_worst(self):
        def run(ate_m, coverage):
            return {"status": "done", "scores": {"ate_m": ate_m, "rotation_deg": 1.0, "rpe_m": None,
                                                 "rpe_deg": None, "coverage": coverage,
                                                 "frames": 10, "why": None}}
        figures = scores.combine([run(0.1, 1.0), run(0.4, 0.5), run(0.2, 0.9),
                                  {"status": "failed", "why": "failed: x"}])
        self.assertEqual(figures["ate_m"], {"median": 0.2, "worst": 0.4, "runs": 3})
        self.assertEqual(figures["coverage"], {"median": 0.7, "worst": 0.0})
        self.assertEqual(figures["why"], "failed: x")

    def test_frames_that_were_dropped_count(self):
        (self.folder / "frames.csv").write_text(TRACKING + "0,0.0,lost,0,,,,,,,,,,,\n" * 6)
        (self.folder / "trajectory.txt").write_text("".join(
            f"{i} {i} 0 0 0 0 0 1\n" for i in range(5)))
        (self.folder / "summary.json").write_text('{"frames": {"in": 10}}')
        figures = scores.score(self.folder)
        self.assertEqual((figures["frames"], figures["coverage"]), (10, 0.5))

    def test_budget(self):
        def summary(dropped, before, latency_ms, backend_ms):
            return {"frames": {"dropped": dropped, "dropped_before_init": before},
                    "latency_ms": {"median": latency_ms, "p95": None},
                    "cpu_ms_per_frame": {"backend": backend_ms, "total": backend_ms + 5}}
        table = tables.budget([("desk", "realtime", [summary(3, 1, 8, 20), summary(4, 4, 9, 21),
                                                     summary(0, 0, 7, 30)]),
                               ("desk", "lockstep", [{"frames": {"dropped": 0}}])])
        self.assertIn("| desk | realtime | 4 | 2 | 8.0 | - | 26.0 | 21.0 |", table)
        self.assertIn("| desk | lockstep | 0 | 0 | - | - | - | - |", table)

    def test_times(self):
        (self.folder / "frames.csv").write_text(
            TRACKING + "0,0.0,tracking,9,5,1,2,7,3,1,3,,,4,12\n1,0.1,lost,0,,,,,,,,,,,\n"
            "2,0.2,tracking,9,7,3,4,,,,3,,,4,20\n")
        (self.folder / "keyframes.csv").write_text(MAPPING + "0,0,0.0,,,,,,10\n1,2,0.2,1,1,1,1,1,30\n")
        summary = timing.summarise([timing.read_times(self.folder)])
        tracking = summary["tracking"]
        self.assertEqual(tracking["total"]["mean_ms"], 16)
        self.assertEqual(tracking["total"]["count"], 2)
        self.assertEqual(tracking["rest"]["mean_ms"], (1 + 6) / 2)
        self.assertIsNone(tracking["rotation"])
        beside, share = tables.overlap(summary)
        self.assertEqual(beside, (5 + 7 + 7 + 3 + 10 + 30) / 2)
        self.assertAlmostEqual(share, 100 * 31 / 47)
        self.assertIn("| Local BA | 1.00 | 1.00 | 1.00 | 1499.37 |", tables.times(summary))

    def test_time_left(self):
        clock = runs.Clock([100, 100, 100])
        clock.skip(0)
        self.assertEqual(clock.at(1, 0), "200 frames left")
        clock._began -= 10
        self.assertEqual(clock.at(1, 50), "about 30 s left")
        self.assertEqual(clock.at(2, 50), "about 10 s left")  # two at once
        clock.at(1, 100)
        self.assertEqual(clock.at(2, 120), "nothing left")

    def test_catalogue_has_the_paper_s_nine(self):
        paper = [each for each in catalogue.TUM if each.paper]
        self.assertEqual(len(paper), 9)
        self.assertAlmostEqual(float(np.mean([each.paper[0] for each in paper])), 0.413 / 9)


if __name__ == "__main__":
    unittest.main()
