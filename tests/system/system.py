"""What the system tests share: `vpslam run` with the real processes, in a network of their own."""

import json
import os
import pathlib
import random
import shutil
import subprocess
import tempfile
import time
import unittest
import uuid

SOURCE = pathlib.Path(__file__).resolve().parents[2]
VPSLAM = str(SOURCE / "scripts" / "vpslam")
WITHOUT_DETECTORS = ["player", "frontend", "backend", "recorder"]
NAMES = WITHOUT_DETECTORS + ["vpdetector1"]  # of a run that is told nothing
# What must repeat exactly; the other files hold times.
RESULTS = ["trajectory.txt", "live_trajectory.txt", "keyframes.txt", "map.ply"]
# A kernel that grants no more, and a network that loses every twentieth message.
BAD_NETWORK = {"VPSLAM_RECV_BUFFER": "212992", "VPSLAM_DROP": "0.05"}


def sequence():
    """The folder that make_sequence.py filled before the tests."""
    return pathlib.Path(os.environ["VPSLAM_TEST_SEQUENCE"])


def private_network():
    """A prefix that gives a command a network namespace of its own, where that is allowed. The
    launcher finds no route there and has to make one. Elsewhere its own port must do."""
    prefix = ["unshare", "--map-root-user", "--net"]
    try:
        allowed = subprocess.run(prefix + ["true"], stderr=subprocess.DEVNULL).returncode == 0
    except FileNotFoundError:
        allowed = False
    return prefix if allowed else []


class SystemTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="vpslam-system-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        (cls.folder / "runtime").mkdir(mode=0o700)
        cls.network = private_network()

    def setUp(self):
        self.tag = uuid.uuid4().hex
        self.sessions = []  # of the runs that this test starts

    def start(self, *arguments, command="run", **environment):
        if command != "bench":  # whose runs have sessions of their own
            self.sessions.append(random.SystemRandom().randrange(1, 1 << 62))
            arguments += ("--session", self.sessions[-1])
        return subprocess.Popen(
            self.network + [VPSLAM, command, *map(str, arguments)], cwd=self.folder, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
            env=dict(os.environ, TAG=self.tag, XDG_RUNTIME_DIR=str(self.folder / "runtime"),
                     **environment))

    def finish(self, process, timeout_s=300):
        output, _ = process.communicate(timeout=timeout_s)
        return process.returncode, output

    def run_to_end(self, *arguments, **environment):
        return self.finish(self.start(*arguments, **environment))

    def inside(self, run, *command):
        """Runs a command in the network of a run and returns what it prints."""
        entrance = ["nsenter", "--user", "--net", "--preserve-credentials", "--target",
                    str(run["launcher"]["pid"])] if self.network else []
        done = subprocess.run(
            [*entrance, *map(str, command)], capture_output=True, text=True, cwd=self.folder,
            env=dict(os.environ, XDG_RUNTIME_DIR=str(self.folder / "runtime")), timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def start_and_wait_for_frames(self, *arguments, names=NAMES):
        """The run's process, and the run as it is registered."""
        process = self.start(*arguments)
        self.wait_until(lambda: self.running(names), "start")
        # Whatever the launcher prints next means that frames come through.
        line = process.stdout.readline()
        while line and not line.startswith("frame"):
            line = process.stdout.readline()
        self.assertTrue(line, "the run ended before any frame came through")
        return process, self.running(names)

    def evaluate(self, out, truth_folder, *arguments, truth="groundtruth.txt"):
        done = subprocess.run(
            [VPSLAM, "evaluate", out / "trajectory.txt", truth_folder / truth,
             "--json", *arguments], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def wait_until(self, condition, what, timeout_s=60):
        deadline = time.monotonic() + timeout_s
        while time.monotonic() < deadline:
            found = condition()
            if found:
                return found
            time.sleep(0.02)
        self.fail(f"{what}: not within {timeout_s} s")

    def running(self, names=NAMES):
        """The one registered run, once all of its processes are there."""
        for path in (self.folder / "runtime" / "vpslam").glob("*.json"):
            run = json.loads(path.read_text())
            if sorted(run["processes"]) == sorted(names):
                return run
        return None

    def assert_same_results(self, first, second):
        for name in RESULTS:
            self.assertEqual((first / name).read_bytes(), (second / name).read_bytes(),
                             f"{name} differs between two runs")

    def processes_left(self):
        left = []
        for entry in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if self.tag.encode() in (entry / "environ").read_bytes():
                    left.append((entry / "cmdline").read_bytes().split(b"\0")[:2])
            except OSError:
                pass
        return left

    def assert_nothing_left(self):
        self.assertEqual(self.processes_left(), [], "processes are left")
        runtime = self.folder / "runtime" / "vpslam"
        self.assertEqual(list(runtime.glob("*")), [], "a run is still registered")
        for session in self.sessions:
            self.assertFalse(pathlib.Path(f"/dev/shm/vpslam-{session}").exists(),
                             "shared memory is left")
