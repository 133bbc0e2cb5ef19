"""A look at a running graph, and commands to it: status, pause, step, rate, preview."""

import json
import os
import pathlib
import re
import unittest

import system

FRAMES = 80
CONSOLE = pathlib.Path(os.environ["VPSLAM_BIN_DIR"]) / "console"


class Steering(system.SystemTest):
    def start_paused(self, name, *arguments):
        """A run that is paused somewhere in its middle."""
        process, run = self.start_and_wait_for_frames(
            system.sequence(), "--out", self.folder / name, "--frames", FRAMES, *arguments)
        self.command(run, "pause")
        self.wait_until(lambda: self.paused_before(run) is not None, "pause")
        return process, run

    def command(self, run, *words):
        self.inside(run, CONSOLE, "command", *words, "--url", run["url"])

    def statuses(self, run):
        lines = self.inside(run, system.VPSLAM, "status", "--json", "--url", run["url"])
        return {row["process"]: row for row in map(json.loads, lines.splitlines())}

    def paused_before(self, run):
        """Number of the next frame, or None if the player is not paused."""
        found = re.search(r"paused before frame (\d+)", self.statuses(run)["player"]["message"])
        return int(found.group(1)) if found else None

    def test_status_pause_step_resume(self):
        process, run = self.start_paused("steered")
        frame = self.paused_before(run)
        self.assertLess(frame, FRAMES - 5)
        self.command(run, "step", "3")
        self.wait_until(lambda: self.paused_before(run) == frame + 3, "three frames")
        table = self.inside(run, system.VPSLAM, "status", "--url", run["url"])
        rows = {line.split()[0]: line for line in table.splitlines()}
        self.assertEqual(list(rows), ["process", "player", "vpdetector", "frontend", "backend",
                                      "recorder"])
        for name in system.WITHOUT_DETECTORS:
            self.assertIn(str(run["processes"][name]["pid"]), rows[name])
            self.assertIn("running", rows[name])
        self.assertEqual(self.statuses(run)["frontend"]["processed"], frame + 3)
        self.command(run, "rate", "8")
        self.command(run, "resume")
        status, output = self.finish(process)
        self.assertEqual(status, 0, output)
        frames = json.loads((self.folder / "steered" / "summary.json").read_text())["frames"]
        self.assertEqual((frames["in"], frames["dropped"]), (FRAMES, 0))
        self.assert_nothing_left()

    def test_previews_come_while_they_are_asked_for(self):
        process, run = self.start_paused("preview", "--record", "features")
        self.command(run, "show")
        self.command(run, "rate", "2")
        self.command(run, "resume")
        status, output = self.finish(process)
        self.assertEqual(status, 0, output)
        log = json.loads((self.folder / "preview" / "summary.json").read_text())["log"]
        previews = log["channels"]["PREVIEW"]
        self.assertGreaterEqual(previews["messages"], 2)
        self.assertLess(previews["bytes"] / previews["messages"], 60200)
        self.assertEqual((self.folder / "preview" / "preview.jpg").read_bytes()[:2], b"\xff\xd8")


if __name__ == "__main__":
    unittest.main()
