"""vpslam run with stand-ins for the processes: what starts, what ends, what is left."""

import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import uuid

SOURCE = pathlib.Path(__file__).resolve().parents[3]
TOOLS = SOURCE / "scripts" / "vpslam_tools"
FAKE = pathlib.Path(__file__).resolve().parent / "fake_process.py"
PATIENCE_S = 60  # on a busy machine
PROGRAMS = ["player", "vpdetector", "frontend", "backend", "recorder"]
WITHOUT_DETECTORS = [name for name in PROGRAMS if name != "vpdetector"]
NAMES = WITHOUT_DETECTORS + ["vpdetector1"]  # of a run that is told nothing


class LauncherTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="vpslam-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        (self.folder / "bin").mkdir()
        for name in PROGRAMS:
            os.symlink(FAKE, self.folder / "bin" / name)
        (self.folder / "runtime").mkdir(mode=0o700)
        sequence = self.folder / "room"
        sequence.mkdir()
        (sequence / "groundtruth.txt").write_text(
            "0.0 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0 1\n0.2 1 1 0 0 0 0 1\n")
        self.tag = uuid.uuid4().hex
        self.sessions = []  # of the runs that this test starts

    def start(self, *arguments, patch="", **environment):
        """`patch`: Python that runs before the command, to shorten its patience."""
        code = (f"import sys; sys.path.insert(0, {str(TOOLS.parent)!r});\n"
                f"from vpslam_tools import cli, supervisor\n{patch}\n"
                "sys.exit(cli.main(sys.argv[1:]))")
        self.sessions.append(random.SystemRandom().randrange(1, 1 << 62))
        arguments += ("--session", str(self.sessions[-1]))
        return subprocess.Popen(
            ["/usr/bin/python3", "-I", "-c", code, *arguments], cwd=self.folder, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
            env=dict(os.environ, VPSLAM_BIN_DIR=str(self.folder / "bin"), TAG=self.tag,
                     XDG_RUNTIME_DIR=str(self.folder / "runtime"), **environment))

    def finish(self, process):
        output, _ = process.communicate(timeout=120)
        return process.returncode, output

    def registered(self):
        return list((self.folder / "runtime" / "vpslam").glob("*.json"))

    def wait_until_running(self, names=NAMES):
        """Returns the registered run once all its processes live and have begun."""
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            for path in self.registered():
                run = json.loads(path.read_text())
                logs = [pathlib.Path(run["out"], "logs", f"{name}.log") for name in names]
                if (sorted(run["processes"]) == sorted(names)
                        and all(log.exists() and "begins" in log.read_text() for log in logs)):
                    return run
            time.sleep(0.02)
        self.fail("the processes did not start")

    def left_running(self):
        found = []
        for entry in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if self.tag.encode() in (entry / "environ").read_bytes():
                    found.append((entry / "cmdline").read_bytes().split(b"\0")[:2])
            except OSError:
                pass
        return found

    def segments(self):
        """Of this test alone: other tests run at the same time."""
        paths = [pathlib.Path(f"/dev/shm/vpslam-{session}") for session in self.sessions]
        return [path for path in paths if path.exists()]

    def assert_nothing_left(self, patience_s=0.0):
        """`patience_s`: for what ends only after the launcher."""
        deadline = time.monotonic() + patience_s
        while time.monotonic() < deadline and (self.left_running() or self.registered()):
            time.sleep(0.05)
        self.assertEqual(self.left_running(), [])
        self.assertEqual(self.registered(), [])
        self.assertEqual(self.segments(), [])


class GoodRun(LauncherTest):
    def test_whole_sequence(self):
        status, output = self.finish(self.start("run", "room", "--out", "out", "--seed", "7"))
        self.assertEqual(status, 0, output)
        self.assertRegex(output, r"LCM URL  udpm://239\.255\.76\.67:\d+\?ttl=0")
        self.assertRegex(output, r"frame \d+  29.5 fps  tracking  keyframes 4  points 321")
        self.assertEqual(output.count("player: the lens is dirty"), 1, "told once")
        self.assertIn("ATE      0.0000 m", output)
        self.assertIn("coverage 0.7500", output)
        self.assertIn(str(self.folder / "out"), output)
        for name in NAMES:
            self.assertTrue((self.folder / "out" / "logs" / f"{name}.log").exists())
        self.assert_nothing_left()

    def test_default_folders_differ_and_ports_too(self):
        runs = [self.start("run", "room") for _ in range(2)]
        outputs = [self.finish(run) for run in runs]
        self.assertEqual([status for status, _ in outputs], [0, 0], outputs)
        folders = list((self.folder / "results").iterdir())
        self.assertEqual(len(folders), 2)
        for folder in folders:
            self.assertRegex(folder.name, r"^\d{4}-\d\d-\d\d_\d{6}-room(-2)?$")
        ports = {re.search(r"udpm://[\d.]+:(\d+)", output).group(1) for _, output in outputs}
        self.assertEqual(len(ports), 2)

    def test_goes_on_where_nobody_reads_what_it_says(self):
        process = self.start("run", "room", "--out", "out", FAKE_SECONDS="1")
        self.wait_until_running()
        process.stdout.close()
        self.assertEqual(process.wait(timeout=PATIENCE_S), 0)
        self.assertTrue((self.folder / "out" / "summary.json").exists())
        self.assert_nothing_left()

    def test_refuses_what_another_run_uses(self):
        process = self.start("run", "room", "--out", "out", FAKE_SECONDS="300")
        url = self.wait_until_running()["url"]
        for arguments, expected in ((["--out", "out"], "a run on room writes there"),
                                    (["--url", url], "a run on room uses its port")):
            status, output = self.finish(self.start("run", "room", *arguments))
            self.assertEqual(status, 1, output)
            self.assertIn(expected, output)
        process.send_signal(signal.SIGINT)
        self.assertEqual(self.finish(process)[0], 0)

    def test_keeps_the_log_of_an_earlier_run(self):
        (self.folder / "out").mkdir()
        (self.folder / "out" / "log.lcm").write_text("earlier")
        self.assertEqual(self.finish(self.start("run", "room", "--out", "out"))[0], 0)
        self.assertFalse((self.folder / "out" / "log.lcm").exists())
        self.assertEqual((self.folder / "out" / "log.lcm.old").read_text(), "earlier")

    def test_a_run_is_registered_while_it_lasts(self):
        process = self.start("run", "room", "--out", "out", FAKE_SECONDS="300",
                             patch="supervisor.INTERRUPT_S = 5")
        run = self.wait_until_running()
        self.assertEqual(os.stat(self.registered()[0].parent).st_mode & 0o777, 0o700)
        self.assertEqual(sorted(run["processes"]), sorted(NAMES))
        self.assertEqual(run["launcher"]["pid"], process.pid)
        command = pathlib.Path(f"/proc/{run['processes']['player']['pid']}/cmdline").read_text()
        self.assertIn(run["url"], command)
        self.assertIn("--session\0" + run["session"], command)
        process.send_signal(signal.SIGTERM)
        self.assertEqual(self.finish(process)[0], 0)
        self.assert_nothing_left()


class Interrupted(LauncherTest):
    def test_ctrl_c_ends_early_with_results(self):
        process = self.start("run", "room", "--out", "out", FAKE_SECONDS="300")
        self.wait_until_running()
        process.send_signal(signal.SIGINT)
        status, output = self.finish(process)
        self.assertEqual(status, 0, output)
        self.assertTrue((self.folder / "out" / "summary.json").exists())
        self.assert_nothing_left()

    def test_ctrl_c_at_any_time_of_the_start(self):
        """By the command itself: Python, its imports and the launcher each have a word in it."""
        for step in range(1, 25):
            delay_s = 0.02 * step
            with self.subTest(delay_s):
                out = self.folder / f"after_{step}"
                self.sessions.append(random.SystemRandom().randrange(1, 1 << 62))
                process = subprocess.Popen(
                    [SOURCE / "scripts" / "vpslam", "run", "room", "--out", out, "--session",
                     str(self.sessions[-1])], cwd=self.folder, text=True, stdin=subprocess.DEVNULL,
                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                    env=dict(os.environ, VPSLAM_BIN_DIR=str(self.folder / "bin"), TAG=self.tag,
                             XDG_RUNTIME_DIR=str(self.folder / "runtime"), FAKE_SECONDS="300"))
                time.sleep(delay_s)
                process.send_signal(signal.SIGINT)
                status, output = self.finish(process)
                self.assertNotIn("Traceback", output)
                self.assertNotIn("SIGINT", output)
                results = (out / "summary.json").exists()
                self.assertEqual(status, 0 if results else 130, output)
                self.assert_nothing_left()
                for done in [*self.folder.glob("*.done"), *self.folder.glob("*.began")]:
                    done.unlink()

    def test_where_nobody_hears_anybody_ctrl_c_ends_at_once(self):
        process = self.start("run", "room", "--out", "out", FAKE_SECONDS="300",
                             FAKE_PLAYER="hang", FAKE_RECORDER="deaf",
                             patch="supervisor.TERMINATE_S = 0.5; "
                             "from vpslam_tools import hearing; hearing.PATIENCE_S = 0.2")
        self.wait_until_running()
        line = process.stdout.readline()
        while line and "hears nothing of" not in line:
            line = process.stdout.readline()
        self.assertIn("hears nothing of player, vpdetector, frontend, backend on udpm://", line)
        begin = time.monotonic()
        process.send_signal(signal.SIGINT)
        status, output = self.finish(process)
        self.assertEqual(status, 130, output)
        self.assertLess(time.monotonic() - begin, 10)
        self.assertIn("no frame came through", output)
        self.assert_nothing_left()

    def test_second_ctrl_c_ends_at_once(self):
        process = self.start("run", "room", "--out", "out", FAKE_PLAYER="hang",
                             patch="supervisor.TERMINATE_S = 0.5")
        self.wait_until_running()
        process.send_signal(signal.SIGINT)
        time.sleep(0.3)
        self.assertIsNone(process.poll())
        process.send_signal(signal.SIGINT)
        self.assertEqual(self.finish(process)[0], 130)
        self.assert_nothing_left()

    def test_killed_launcher_leaves_nothing(self):
        process = self.start("run", "room", "--out", "out", FAKE_SECONDS="300",
                             FAKE_FRONTEND="hang")
        self.wait_until_running()
        self.assertNotEqual(self.segments(), [])
        process.kill()
        self.finish(process)
        self.assert_nothing_left(patience_s=PATIENCE_S)


class FailingProcess(LauncherTest):
    def test_failure_is_told_with_the_log(self):
        status, output = self.finish(self.start("run", "room", "--out", "out",
                                                FAKE_FRONTEND="fail", FAKE_SECONDS="300"))
        self.assertEqual(status, 1)
        self.assertIn("frontend failed with exit code 3", output)
        self.assertIn("cannot read the stars; clean the lens", output)
        self.assertNotIn("player failed", output)
        self.assertTrue((self.folder / "out" / "summary.json").exists(), "the recorder lives")
        self.assert_nothing_left()

    def test_killed_process(self):
        for name in ("player", "backend", "recorder"):
            with self.subTest(name):
                out = self.folder / f"{name}_killed"
                process = self.start("run", "room", "--out", str(out), FAKE_SECONDS="300")
                run = self.wait_until_running()
                os.kill(run["processes"][name]["pid"], signal.SIGKILL)
                status, output = self.finish(process)
                self.assertEqual(status, 1)
                self.assertIn(f"{name} was killed by SIGKILL", output)
                self.assertEqual((out / "summary.json").exists(), name != "recorder")
                self.assert_nothing_left()
                for done in self.folder.glob("*.done"):
                    done.unlink()

    def test_killed_frontend_is_started_again(self):
        process = self.start("run", "room", "--out", "out", FAKE_SECONDS="300")
        run = self.wait_until_running()
        first = run["processes"]["frontend"]["pid"]
        os.kill(first, signal.SIGKILL)
        line = process.stdout.readline()
        while line and "started again" not in line:
            line = process.stdout.readline()
        self.assertIn("frontend was killed by SIGKILL; it is started again (1 of", line)
        deadline = time.monotonic() + PATIENCE_S
        while run["processes"]["frontend"]["pid"] == first and time.monotonic() < deadline:
            run = self.wait_until_running()
        self.assertNotEqual(run["processes"]["frontend"]["pid"], first)
        log = self.folder / "out" / "logs" / "frontend.log"
        while log.read_text().count("begins") < 2 and time.monotonic() < deadline:
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        status, output = self.finish(process)
        self.assertEqual(status, 0, output)
        self.assertEqual(log.read_text().count("begins"), 2, "what it said before is kept")
        self.assert_nothing_left()

    def test_what_crashes_again_and_again_ends_the_run(self):
        status, output = self.finish(self.start(
            "run", "room", "--out", "out", FAKE_SECONDS="300", FAKE_FRONTEND="crash",
            patch="from vpslam_tools import restarts; restarts.DELAYS_S = [0.05]"))
        self.assertEqual(status, 1)
        self.assertIn("(3 of at most 3 times a minute)", output)
        self.assertIn("frontend was killed by SIGKILL, again and again; ", output)
        self.assertTrue((self.folder / "out" / "summary.json").exists(), "the recorder lives")
        self.assert_nothing_left()

    def test_source_that_breaks_down_is_worked_off(self):
        status, output = self.finish(self.start("run", "room", "--out", "out",
                                                FAKE_PLAYER="break"))
        self.assertEqual(status, 1)
        self.assertIn("player failed with exit code 4", output)
        self.assertIn("by itself", (self.folder / "out" / "logs" / "recorder.log").read_text())
        self.assert_nothing_left()

    def test_process_that_ends_too_early(self):
        status, output = self.finish(self.start("run", "room", "--out", "out", FAKE_SECONDS="300",
                                                FAKE_BACKEND="early",
                                                patch="supervisor.OUT_OF_TURN_S = 0.3"))
        self.assertEqual(status, 1)
        self.assertIn("backend ended while player was still running", output)
        self.assert_nothing_left()

    def test_process_that_never_ends(self):
        status, output = self.finish(self.start(
            "run", "room", "--out", "out", FAKE_BACKEND="hang",
            patch="supervisor.DRAIN_S = 0.5; supervisor.TERMINATE_S = 0.5"))
        self.assertEqual(status, 1)
        self.assertIn("backend did not end in time", output)
        self.assertTrue((self.folder / "out" / "summary.json").exists())
        self.assert_nothing_left()

    def test_missing_binary(self):
        (self.folder / "bin" / "backend").unlink()
        status, output = self.finish(self.start("run", "room", "--out", "out"))
        self.assertEqual(status, 1)
        self.assertIn("backend: cannot be started", output)
        self.assertNotIn("Traceback", output)
        self.assert_nothing_left()


class Detectors(LauncherTest):
    DETECTORS = ["vpdetector1", "vpdetector2"]

    def start_two(self, patch=""):
        process = self.start("run", "room", "--out", "out", "--detectors", "2", FAKE_SECONDS="300",
                             patch=patch)
        return process, self.wait_until_running(WITHOUT_DETECTORS + self.DETECTORS)

    def test_none_where_there_is_nothing_for_them_to_do(self):
        for arguments, detectors in ((["--preset", "points"], 0), (["--preset", "paper"], 1),
                                     (["--preset", "points", "--lines", "on"], 1),
                                     (["--preset", "points", "--detectors", "1"], 1),
                                     (["--detectors", "0"], 0), ([], 1)):
            with self.subTest(arguments):
                out = self.folder / "-".join(["out", *arguments])
                status, output = self.finish(
                    self.start("run", "room", "--out", str(out), *arguments))
                self.assertEqual(status, 0, output)
                self.assertEqual(len(list((out / "logs").glob("vpdetector*"))), detectors)
                for done in self.folder.glob("*.done"):
                    done.unlink()

    NO_RESTARTS = "from vpslam_tools import restarts; restarts.LIMIT = supervisor.LIMIT = 0"

    def test_a_killed_one_is_started_again(self):
        process, run = self.start_two()
        first = run["processes"]["vpdetector2"]["pid"]
        os.kill(first, signal.SIGKILL)
        line = process.stdout.readline()
        while line and "vpdetector2" not in line:
            line = process.stdout.readline()
        self.assertIn("vpdetector2 was killed by SIGKILL; it is started again", line)
        deadline = time.monotonic() + PATIENCE_S
        while run["processes"]["vpdetector2"]["pid"] == first and time.monotonic() < deadline:
            run = self.wait_until_running(WITHOUT_DETECTORS + self.DETECTORS)
        process.send_signal(signal.SIGINT)
        self.assertEqual(self.finish(process)[0], 0)
        self.assert_nothing_left()

    def test_the_loss_of_one_is_told(self):
        process, run = self.start_two(self.NO_RESTARTS)
        os.kill(run["processes"]["vpdetector2"]["pid"], signal.SIGKILL)
        line = process.stdout.readline()
        while line and "vpdetector2" not in line:
            line = process.stdout.readline()
        self.assertEqual(line.strip(), "vpdetector2 was killed by SIGKILL, again and again; the "
                                       "run goes on with vpdetector1")
        process.send_signal(signal.SIGINT)
        status, output = self.finish(process)
        self.assertEqual(status, 0, output)
        self.assert_nothing_left()

    def test_the_loss_of_all_is_a_failure(self):
        process, run = self.start_two(self.NO_RESTARTS)
        for name in self.DETECTORS:
            os.kill(run["processes"][name]["pid"], signal.SIGKILL)
        status, output = self.finish(process)
        self.assertEqual(status, 1)
        self.assertRegex(output, r"vpdetector\d was killed by SIGKILL, again and again; .*vpdetector\d.log ends")
        self.assertTrue((self.folder / "out" / "summary.json").exists())
        self.assert_nothing_left()

    def test_one_that_hangs_does_not_hold_up_the_end(self):
        status, output = self.finish(self.start(
            "run", "room", "--out", "out", "--detectors", "1", FAKE_VPDETECTOR="hang",
            patch="supervisor.TERMINATE_S = 0.5"))
        self.assertEqual(status, 0, output)
        self.assert_nothing_left()

    def test_what_they_and_the_others_are_told(self):
        process, run = self.start_two()

        def words(name):
            path = pathlib.Path(f"/proc/{run['processes'][name]['pid']}/cmdline")
            return path.read_text().split("\0")
        self.assertIn("frontend,backend,recorder,vpdetector", words("player"))
        self.assertIn("frontend,backend,recorder,vpdetector", words("frontend"))
        self.assertIn(run["url"], words("vpdetector2"))
        process.send_signal(signal.SIGINT)
        self.assertEqual(self.finish(process)[0], 0)


class Leftovers(LauncherTest):
    def test_next_run_sweeps(self):
        runtime = self.folder / "runtime" / "vpslam"
        runtime.mkdir(mode=0o700)
        session = str(uuid.uuid4().int & (1 << 60) - 1)
        segment = pathlib.Path(f"/dev/shm/vpslam-{session}")
        segment.write_text("pixels")
        # The launcher's id is that of a living process, but not its start: another process now.
        (runtime / f"{session}.json").write_text(json.dumps(
            {"session": session, "url": "", "sequence": "", "out": "", "started": "",
             "launcher": {"pid": os.getpid(), "start": 1},
             "processes": {"player": {"pid": os.getpid(), "start": 1}}}))
        (runtime / "rubbish.json").write_text("{")
        status, output = self.finish(self.start("run", "room", "--out", "out"))
        self.assertEqual(status, 0, output)
        self.assertFalse(segment.exists())
        self.assertEqual([path.name for path in self.registered()], ["rubbish.json"])


class BadInput(LauncherTest):
    def test_one_line(self):
        (self.folder / "file").write_text("")
        for arguments, expected in (
                (["nowhere"], "nowhere: no such folder, video or camera"),
                (["room", "--camera", "none.yaml"], "none.yaml: no such file; check --camera"),
                (["room", "--config", "none.yaml"], "none.yaml: no such file; check --config"),
                (["room", "--set", "orb.levels=3"], "--set orb.levels=3: write it as"),
                (["room", "--preset", "paper", "--rotation", "fused"], "add --manhattan on"),
                (["room", "--out", "file"], "file: cannot be made")):
            with self.subTest(arguments):
                status, output = self.finish(self.start("run", *arguments))
                self.assertEqual(status, 1)
                self.assertIn(expected, output)
                self.assertEqual(output.count("\n"), 1, output)
        for arguments in (["room", "--frames", "0"], ["room", "--seed", "x"], ["room", "--pase"]):
            with self.subTest(arguments):
                self.assertEqual(self.finish(self.start("run", *arguments))[0], 2)
        self.assert_nothing_left()


if __name__ == "__main__":
    unittest.main()
