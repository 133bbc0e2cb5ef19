"""`vpslam bench --suite spread`: which runs it plans, its statistics, what it compares with, and what
it runs again. A stand-in takes the place of offline_slam."""

import csv
import math
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
from vpslam_tools.benchmark import paired, spread  # noqa: E402
from vpslam_tools.errors import UserError  # noqa: E402
from vpslam_tools.suites import spread as suite  # noqa: E402

FRAMES = 30
# Errs by 1 cm times its seed, by the setting more; tracks all frames but the last. "crash": it fails.
FAKE = f"""#!/usr/bin/python3
import os, pathlib, sys, time
def option(flag): return sys.argv[sys.argv.index(flag) + 1] if flag in sys.argv else "0"
with open(os.environ["FAKE_COUNT"], "a") as file: file.write(" ".join(sys.argv[1:]) + "\\n")
print("frame 3 state 2 live 1", file=sys.stderr, flush=True)
name = os.path.basename(sys.argv[1])
if "backend.bad=1" in sys.argv: sys.exit(2 * (print("bad: there is no such setting") is None))
if os.environ.get("FAKE_FAILS") == name: sys.exit("the lens is dirty")
if os.environ.get("FAKE_SLEEPS"): time.sleep(60)
start, out = int(option("--start")), pathlib.Path(option("--out"))
error = 0.01 * int(option("--seed")) * (2 if "backend.worse=2" in sys.argv else 1)
def poses(frames): return "".join(
    f"{{i / 10:.1f}} {{i}} {{i * i / 10 + error * (-1) ** i}} 0 0 0 0 1\\n" for i in frames)
out.joinpath("trajectory.txt").write_text(poses(range(start, {FRAMES} - 1)))
out.joinpath("frames.csv").write_text("frame\\n" + "0\\n" * ({FRAMES} - start - 2))
out.joinpath("summary.json").write_text('{{"frames": {{"in": 0}}}}')
"""
FAKE_PLAYER = f"""#!/usr/bin/python3
import os, pathlib, sys
with open(os.environ["FAKE_COUNT"], "a") as file: file.write("rendered\\n")
folder = pathlib.Path(sys.argv[sys.argv.index("--to") + 1])
(folder / "rgb").mkdir(parents=True)
(folder / "rgb" / "0.png").write_text("pixels")
(folder / "rgb.txt").write_text("0.0 rgb/0.png\\n" * {FRAMES})
"""


def row(sequence="a", start=0, seed=1, ate_m=0.1, rotation_deg=1.0, coverage=1.0, **about):
    return {**dict.fromkeys(spread.COLUMNS), "sequence": sequence, "start": start, "seed": seed,
            "status": "done", "frames": 10, "inputs": "x", "ate_m": ate_m,
            "rotation_deg": rotation_deg, "coverage": coverage, **about}


class Planning(unittest.TestCase):
    def test_ten_runs_have_each_start_with_each_seed(self):
        self.assertEqual({spread.start_and_seed(number) for number in range(10)},
                         {(start, seed) for start in range(5) for seed in (1, 2)})

    def test_half_of_them_has_each_start_and_both_seeds(self):
        first = [spread.start_and_seed(number) for number in range(5)]
        self.assertEqual([start for start, _ in first], list(range(5)))
        self.assertEqual({seed for _, seed in first}, {1, 2})

    def test_more_runs_have_further_seeds(self):
        self.assertEqual({seed for _, seed in map(spread.start_and_seed, range(10, 20))}, {3, 4})


class Scatter(unittest.TestCase):
    ATE, _, COVERAGE = spread.METRICS

    def test_median_ninety_percent_and_worst(self):
        rows = [row(ate_m=ate, coverage=1 - ate) for ate in (.1, .9, .3, .2, .4, .5, .6, .7, .8, 1.)]
        for got, expected in ((spread.scatter(self.ATE, rows), (.55, .9, 1.0)),
                              (spread.scatter(self.COVERAGE, rows), (.45, .1, .0))):
            for one, other in zip(got, expected):
                self.assertAlmostEqual(one, other)

    def test_what_was_not_tracked_is_worse_than_all(self):
        rows = [row(ate_m=.1), row(ate_m=.3), row(ate_m=None)]
        self.assertEqual(spread.scatter(self.ATE, rows), (.3, math.inf, math.inf))
        text = spread.table(spread.summarise(rows), 3)
        self.assertIn("| a | 3 | 0.3000 | none | none |", text)

    def test_the_table_says_what_is_yet_to_come(self):
        self.assertIn("| a | 1 of 10, 1 failed |",
                      spread.table(spread.summarise([row(status="failed")]), 10))

    def test_rows_survive_the_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "runs.csv")
            rows = [row(sequence="lr, kt 0", ate_m=1 / 3, poses=7, wall_s=1.5, programs="p",
                        settings="", why="no pose: \"none\""), row(ate_m=None, programs="p",
                                                                   settings="a b", why="")]
            spread.write_csv(path, spread.COLUMNS, rows)
            self.assertEqual(spread.read_rows(path), rows)
            path.write_text("sequence,start\na,b\n")
            with self.assertRaisesRegex(UserError, r"runs\.csv:2: is no row"):
                spread.read_rows(path)


class SignTest(unittest.TestCase):
    def test_known_values(self):
        # Sums of binomials by hand: 2 (1 + 10) / 1024, 2 (1 + 8 + 28) / 256, ...
        for better, worse, expected in ((0, 0, 1.0), (1, 0, 1.0), (5, 0, 0.0625), (10, 0, 2 / 1024),
                                        (9, 1, 22 / 1024), (1, 9, 22 / 1024), (2, 6, 74 / 256),
                                        (5, 5, 1.0), (15, 5, 0.041389465)):
            with self.subTest(better=better, worse=worse):
                self.assertAlmostEqual(paired.sign_test(better, worse), expected, places=8)

    def test_pairs_have_the_same_start_and_seed_and_saw_the_same(self):
        baseline = [row(start=0), row(start=1), row(start=2), row(sequence="b")]
        judged = [row(start=0), row(start=1, frames=9), row(start=2, inputs="y"),
                  row(start=0, seed=2), row(sequence="c")]
        pairs, unlike = paired.pair(baseline, judged)
        self.assertEqual(pairs, [(baseline[0], judged[0])])
        self.assertEqual(unlike, {"a": 2})

    def test_directions_and_ties(self):
        pairs = [(row(ate_m=.2, coverage=.5), row(ate_m=.1, coverage=.4)),
                 (row(ate_m=None, coverage=.5), row(ate_m=.1, coverage=.6)),
                 (row(ate_m=None, coverage=.5), row(ate_m=None, coverage=.5)),
                 (row(ate_m=.1, coverage=.5), row(ate_m=.1, coverage=.4)),
                 (row("b", ate_m=.2), row("b", ate_m=.3))]
        lines = {(line["metric"], line["sequence"]): line for line in paired.compare(pairs)}

        def signs(*key):
            return [lines[key][what] for what in ("pairs", "better", "worse", "equal")]
        self.assertEqual(signs("ate_m", "a"), [4, 2, 0, 2])
        self.assertEqual(signs("ate_m", "all"), [5, 2, 1, 2])
        self.assertEqual(signs("coverage", "a"), [4, 1, 2, 1])
        self.assertEqual(signs("rotation_deg", "all"), [5, 0, 0, 5])
        self.assertEqual(lines["ate_m", "all"]["p"], 1.0)
        self.assertAlmostEqual(lines["ate_m", "b"]["ratio"], 1.5)
        self.assertIsNone(lines["ate_m", "a"]["ratio"])  # of a median that is none
        self.assertIn("| all | 5 | - | - | 1.500 | 2 | 1 | 2 | 1.000 |",
                      paired.text(list(lines.values())))


class AgainstWhat(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="vpslam-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def test_settings(self):
        for text, expected in (
                ("backend.a=1", ("backend.a=1",)),
                ("backend.a.b=1,frontend.c=x", ("backend.a.b=1", "frontend.c=x")),
                ("backend.a=[1,2],vpdetector.d=-0.5", ("backend.a=[1,2]", "vpdetector.d=-0.5")),
                ("defaults", ())):
            self.assertEqual(suite.parse_against(text), suite.Against(settings=expected))

    def test_folders(self):
        (self.folder / "bin").mkdir()
        with self.assertRaisesRegex(UserError, "neither runs.csv .* nor bin/offline_slam"):
            suite.parse_against(str(self.folder))
        (self.folder / "bin" / "offline_slam").touch()
        self.assertEqual(suite.parse_against(str(self.folder)).program,
                         self.folder / "bin" / "offline_slam")
        (self.folder / "runs.csv").touch()
        self.assertEqual(suite.parse_against(str(self.folder)).results, self.folder)

    def test_neither(self):
        for text in ("nowhere", "a.b=1", "backend.a", "backend.a=1,", "backend.a=,backend.b=1"):
            with self.subTest(text), self.assertRaisesRegex(UserError, f"--against {text}: is no"):
                suite.parse_against(text)


class Command(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="vpslam-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.build("bin")
        self.count = self.folder / "count"
        for name in ("car_park", "mine"):
            folder = self.folder / "data" / name
            folder.mkdir(parents=True)
            (folder / "rgb.txt").write_text("0.0 a\n" * FRAMES)
            (folder / "groundtruth.txt").write_text("".join(
                f"{i / 10:.1f} {i} {i * i / 10} 0 0 0 0 1\n" for i in range(FRAMES)))

    def build(self, name, text=FAKE):
        (self.folder / name).mkdir(parents=True)
        for program, content in (("offline_slam", text), ("player", FAKE_PLAYER)):
            (self.folder / name / program).write_text(content)
            (self.folder / name / program).chmod(0o755)

    def command(self, *arguments):
        return ["/usr/bin/python3", "-I", str(SOURCE / "scripts" / "vpslam_tools"), "bench", "--suite",
                "spread", "--data", "data", *arguments]

    def environment(self, **more):
        return dict(os.environ, VPSLAM_BIN_DIR=str(self.folder / "bin"), FAKE_COUNT=str(self.count),
                    **more)

    def bench(self, *arguments, **environment):
        self.count.write_text("")
        done = subprocess.run(self.command(*arguments), cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              env=self.environment(**environment))
        return done.returncode, done.stdout, len(self.count.read_text().splitlines())

    def read(self, name):
        with open(self.folder / name, encoding="utf-8") as file:
            return list(csv.DictReader(file))

    REAL = ("--sequence", "car_park", "--sequence", "mine")

    def test_tables(self):
        status, output, count = self.bench(*self.REAL, "--runs", "3", "--out", "out")
        self.assertEqual((status, count), (0, 6), output)
        rows = self.read("out/runs.csv")
        self.assertEqual([(each["sequence"], each["start"], each["seed"]) for each in rows],
                         [(name, start, seed) for start, seed in (("0", "1"), ("1", "2"), ("2", "1"))
                          for name in ("car_park", "mine")])
        # What the sequence has, not what the stand-in counted.
        self.assertEqual([each["frames"] for each in rows[::2]], ["30", "29", "28"])
        self.assertAlmostEqual(float(rows[2]["coverage"]), 28 / 29)
        self.assertAlmostEqual(float(rows[2]["ate_m"]), 0.02, delta=0.001)
        self.assertIn("| car_park | 3 | 0.01", output)
        self.assertIn((self.folder / "out" / "results.md").read_text(), output)
        self.assertEqual([each["runs"] for each in self.read("out/summary.csv")], ["3", "3"])
        self.assertIn("nothing left", output)

    def test_goes_on_where_it_stopped(self):
        options = ("--sequence", "mine", "--out", "out")
        self.assertEqual(self.bench(*options, "--runs", "1")[2], 1)
        self.assertEqual(self.bench(*options, "--runs", "2")[2], 1)
        self.assertEqual(len(self.read("out/runs.csv")), 2)
        self.assertEqual(self.bench(*options, "--runs", "2", "--set", "backend.x=1")[2], 2)
        self.assertEqual(self.bench(*options, "--runs", "2", "--set", "backend.x=1")[2], 0)
        with open(self.folder / "bin" / "offline_slam", "a", encoding="utf-8") as file:
            file.write("# another\n")
        self.assertEqual(self.bench(*options, "--runs", "2", "--set", "backend.x=1")[2], 2)

    def test_what_is_interrupted_is_not_kept(self):
        process = subprocess.Popen(self.command("--sequence", "mine", "--out", "out", "--runs", "4"),
                                   cwd=self.folder, env=self.environment(FAKE_SLEEPS="1"),
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        patience = time.monotonic() + 60
        while not (self.count.exists() and len(self.count.read_text().splitlines()) == 2):
            self.assertLess(time.monotonic(), patience)
            time.sleep(0.05)
        process.send_signal(signal.SIGTERM)
        self.assertNotEqual(process.wait(timeout=30), 0)
        self.assertEqual(list(self.folder.rglob("bench.json")), [])
        self.assertEqual(self.bench("--sequence", "mine", "--out", "out", "--runs", "4")[2], 4)

    def test_a_failure_is_told_and_tried_again(self):
        options = (*self.REAL, "--out", "out", "--runs", "1")
        status, output, _ = self.bench(*options, FAKE_FAILS="mine")
        self.assertEqual(status, 1, output)
        self.assertIn("| mine | 1, 1 failed | none | none | none |", output)
        self.assertIn("- mine: failed: the lens is dirty", output)
        self.assertEqual(self.bench(*options)[::2], (0, 1))

    def test_against_settings(self):
        status, output, count = self.bench(*self.REAL, "--runs", "6", "--out", "out", "--set",
                                           "backend.worse=2", "--against", "defaults")
        self.assertEqual((status, count), (0, 24), output)
        lines = {(line["metric"], line["sequence"]): line for line in self.read("out/comparison.csv")}
        ate = lines["ate_m", "mine"]
        self.assertEqual([ate[key] for key in ("pairs", "better", "worse", "equal")],
                         ["6", "0", "6", "0"])
        self.assertAlmostEqual(float(ate["ratio"]), 2, delta=0.05)
        self.assertAlmostEqual(float(ate["p"]), 2 / 64)
        self.assertAlmostEqual(float(lines["ate_m", "all"]["p"]), 2 / 4096)
        self.assertEqual(lines["coverage", "all"]["equal"], "12")
        self.assertIn("## Against defaults", output)

    def test_against_a_build_and_its_results(self):
        self.build("other/bin", FAKE.replace("0.01 *", "0.03 *"))
        options = ("--sequence", "mine", "--runs", "2", "--out", "out")
        status, output, count = self.bench(*options, "--against", "other")
        self.assertEqual((status, count), (0, 4), output)
        self.assertIn("| mine | 2 | 0.04", output)
        built = self.read("out/comparison.csv")
        self.assertEqual(built[0]["better"], "2")
        earlier, = (self.folder / "out" / "against").rglob("runs.csv")
        status, output, count = self.bench(*options, "--against", str(earlier.parent))
        self.assertEqual((status, count), (0, 0), output)
        self.assertEqual(self.read("out/comparison.csv"), built)

    def test_other_frames_are_not_compared(self):
        options = ("--sequence", "mine", "--runs", "1")
        self.bench(*options, "--out", "before")
        status, output, _ = self.bench(*options, "--out", "out", "--frames", "7", "--against",
                                       "before")
        self.assertEqual(status, 0, output)
        self.assertIn("mine: 1 runs are left out", output)
        self.assertIn("No pair is complete", output)

    def test_simulated_places_are_rendered_once(self):
        options = ("--sequence", "room", "--runs", "1")
        status, output, count = self.bench(*options, "--out", "before")
        self.assertEqual((status, count), (0, 2), output)
        self.assertEqual(self.bench(*options, "--out", "before")[2], 0)
        self.assertEqual(self.bench(*options, "--out", "out", "--against", "before")[2], 1)
        self.assertFalse((self.folder / "out" / "sequences").exists())

    def test_bad_arguments(self):
        for arguments, expected in (
                (["--pace", "lockstep"], "leave --pace out"),
                (["--seeds", "2"], "--runs"),
                (["--set", "nothing"], "--set nothing: write it as"),
                (["--config", "none.yaml"], "none.yaml: no such file"),
                (["--against", "nowhere"], "--against nowhere: is no folder"),
                (["--sequence", "moon"], "--sequence moon"),
                (["--sequence", "mine", "--set", "backend.bad=1"], "offline_slam refuses the options")):
            with self.subTest(arguments):
                status, output, _ = self.bench("--out", "out", *arguments)
                self.assertEqual(status, 1, output)
                self.assertIn(expected, output)
                self.assertNotIn("Traceback", output)


if __name__ == "__main__":
    unittest.main()
