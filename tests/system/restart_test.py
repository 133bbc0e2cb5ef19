"""A frontend that is killed and started again goes on in the same map."""

import csv
import json
import os
import pathlib
import signal
import subprocess
import sys
import unittest

import system

sys.path.insert(0, str(system.SOURCE / "scripts"))

KILL_AFTER = 70       # frames
# What the killed one had in hand is among them. In lockstep the player waits; in real time the new
# one has two seconds, of which the sequence leaves 1.6.
MAX_FRAMES_LOST = {"lockstep": 15, "realtime": 45}
MAX_ATE_M = 0.02


def run_graph(sequence, out, pace):
    """The graph by hand, since a launcher would end a run whose frontend dies."""
    from vpslam_tools import multicast, paths
    multicast.ensure_multicast()
    url = f"udpm://239.255.76.67:{20000 + os.getpid() % 20000}?ttl=0&recv_buf_size=4194304"
    running = []

    def start(name, *arguments, **options):
        log = open(out / f"{name}-{len(running)}.log", "w")
        running.append(subprocess.Popen([paths.binaries() / name, "--url", url, "--pace",
                                         pace, *arguments], stderr=log, **{"stdout": log, **options}))
        return running[-1]

    try:
        recorder = start("recorder", "--out", str(out), "--progress", stdout=subprocess.PIPE,
                         text=True)
        backend = start("backend")
        frontend = start("frontend")
        player = start("player", str(sequence))
        for line in recorder.stdout:
            if frontend and json.loads(line)["frame"] >= KILL_AFTER:
                frontend.send_signal(signal.SIGKILL)
                frontend.wait()
                again, frontend = start("frontend"), None
        return [process.wait(timeout=60) for process in (player, again, backend, recorder)]
    finally:
        for process in running:
            if process.poll() is None:
                process.kill()
                process.wait()


class Restart(system.SystemTest):
    def test_tracks_again_in_the_same_map(self):
        self.check("lockstep")

    def test_in_real_time_too(self):
        self.check("realtime")

    def check(self, pace):
        out = self.folder / pace
        out.mkdir()
        done = subprocess.run(
            self.network + [sys.executable, "-s", __file__, str(system.sequence()), str(out),
                            pace],
            capture_output=True, text=True, timeout=300)
        logs = "".join(path.read_text()[-1000:] for path in sorted(out.glob("*.log")))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr + logs)
        self.assertEqual(json.loads(done.stdout.splitlines()[-1]), [0, 0, 0, 0], logs)
        summary = json.loads((out / "summary.json").read_text())
        self.assertEqual(summary["maps"], 1)
        with open(out / "frames.csv", newline="") as table:
            states = {int(row["frame"]): row["state"] for row in csv.DictReader(table)}
        frames = len((system.sequence() / "rgb.txt").read_text().splitlines())
        missing = [frame for frame in range(KILL_AFTER - 10, frames)
                   if states.get(frame) != "tracking"]
        self.assertLessEqual(len(missing), MAX_FRAMES_LOST[pace], missing)
        self.assertEqual(states[frames - 1], "tracking")
        with open(out / "keyframes.csv", newline="") as table:
            ids = [int(row["keyframe"]) for row in csv.DictReader(table)]
        self.assertEqual(len(ids), len(set(ids)))
        result = self.evaluate(out, system.sequence())
        self.assertLess(result["ate_m"]["rmse"], MAX_ATE_M)


if __name__ == "__main__":
    if len(sys.argv) == 4 and not sys.argv[1].startswith("-"):
        print(json.dumps(run_graph(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]),
                                   sys.argv[3])))
    else:
        unittest.main()
