"""The paces at which mapping runs beside tracking: nothing lost in lossless, nobody waited for in
realtime."""

import csv
import json
import os
import re
import signal
import time
import unittest

import system

FRAMES = 90  # 3 s


class Paces(system.SystemTest):
    def play(self, name, pace, *arguments, **environment):
        out = self.folder / name
        began = time.monotonic()
        status, output = self.run_to_end(system.sequence(), "--out", out, "--frames", FRAMES,
                                         "--pace", pace, *arguments, **environment)
        self.assertEqual(status, 0, output)
        self.assert_nothing_left()
        self.wall_s = time.monotonic() - began
        self.output = output
        return out, json.loads((out / "summary.json").read_text())

    def assert_every_frame(self, out, summary):
        """At the frontend, by what it and the recorder say; and at the backend, by keyframes."""
        self.assertEqual(summary["frames"]["in"], FRAMES)
        self.assertEqual(summary["frames"]["processed"], FRAMES)
        self.assertEqual(summary["frames"]["dropped"], 0)
        with open(out / "frames.csv", newline="") as table:
            self.assertEqual([int(row["frame"]) for row in csv.DictReader(table)],
                             list(range(FRAMES)))
        with open(out / "keyframes.csv", newline="") as table:
            numbers = [int(row["keyframe"]) for row in csv.DictReader(table)]
        self.assertEqual(numbers, list(range(numbers[0], numbers[0] + len(numbers))))
        for process, messages in summary["messages"].items():
            self.assertEqual((process, messages["dropped"]), (process, 0))
        self.assertEqual(summary["messages"]["frontend"]["processed"], FRAMES)
        # An image whose answer was lost is sent, and answered, again.
        answered = summary["messages"]["vpdetector"]["processed"]
        if sum(messages["resent"] for messages in summary["messages"].values()):
            self.assertGreaterEqual(answered, FRAMES)
        else:
            self.assertEqual(answered, FRAMES)

    def assert_good(self, out, summary):
        self.assertGreaterEqual(summary["frames"]["tracked"], 0.9 * FRAMES)
        result = self.evaluate(out, system.sequence())
        self.assertLess(result["ate_m"]["rmse"], 0.03)

    def test_lossless(self):
        out, summary = self.play("lossless", "lossless")
        self.assert_every_frame(out, summary)
        self.assert_good(out, summary)
        self.assertEqual(summary["options"]["pace"], "lossless")

    def test_lossless_on_a_bad_network(self):
        out, summary = self.play("lossy", "lossless", **system.BAD_NETWORK)
        self.assert_every_frame(out, summary)
        self.assertGreater(sum(losses["resent"] for losses in summary["messages"].values()), 0)
        self.assert_good(out, summary)

    def test_inline_pixels_and_a_small_buffer(self):
        out, summary = self.play("inline", "lossless", "--inline", **system.BAD_NETWORK)
        self.assert_every_frame(out, summary)
        self.assertRegex(self.output, r"player: images of \d+ kB travel in the messages .*"
                         "recv_buf_size=")

    def test_realtime_keeps_the_tempo(self):
        out, summary = self.play("realtime", "realtime")
        self.assertEqual(summary["frames"]["in"], FRAMES)
        self.assertGreater(self.wall_s, (FRAMES - 1) / 30)
        self.assertGreater(summary["wall_s"], 0.9 * (FRAMES - 1) / 30)
        # How many frames a machine under load can work on is not for this test to say.
        self.assertGreater(summary["frames"]["processed"], FRAMES // 3)
        self.assertEqual(
            summary["frames"]["dropped"],
            sum(summary["messages"]["frontend"][kind] for kind in ("dropped", "gaps", "rejected")))
        self.assertIn(f"played {FRAMES} of {FRAMES} images", self.output)

    def test_realtime_waits_for_nobody(self):
        out = self.folder / "stopped"
        process = self.start(system.sequence(), "--out", out, "--frames", FRAMES, "--pace",
                             "realtime")
        run = self.wait_until(self.running, "start")
        line = process.stdout.readline()
        while line and not line.startswith("frame"):
            line = process.stdout.readline()
        frontend = run["processes"]["frontend"]["pid"]
        os.kill(frontend, signal.SIGSTOP)
        time.sleep(1)
        os.kill(frontend, signal.SIGCONT)
        status, output = self.finish(process)
        self.assertEqual(status, 0, output)
        frames = json.loads((out / "summary.json").read_text())["frames"]
        self.assertEqual(frames["in"], FRAMES, "the player went on")
        self.assertGreater(frames["dropped"], 10)
        dropped = re.search(rf"no pose for \d+ of {FRAMES} images: (\d+) dropped", output)
        self.assertEqual(int(dropped.group(1)), frames["dropped"], output)
        self.assert_nothing_left()


if __name__ == "__main__":
    unittest.main()
