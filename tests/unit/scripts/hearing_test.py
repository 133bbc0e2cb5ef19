"""Processes of a graph that do not hear each other are named, once."""

import json
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))

from vpslam_tools import errors, multicast  # noqa: E402
from vpslam_tools.errors import UserError  # noqa: E402
from vpslam_tools.hearing import PATIENCE_S, Hearing  # noqa: E402

PROGRAMS = ["player", "vpdetector", "frontend", "backend", "recorder"]


class HearingTest(unittest.TestCase):
    def setUp(self):
        self.now, self.told = 100.0, []
        self.hearing = Hearing(PROGRAMS, "udpm://here", self.told.append, lambda: self.now)

    def look(self, heard, frames_come=False):
        self.hearing.look(json.dumps({"processes": dict.fromkeys(heard, "ready")}), frames_come)

    def test_who_is_not_heard_in_time_is_named_once(self):
        self.look(["player"])
        self.now += PATIENCE_S - 0.1
        self.look(["player"])
        self.assertEqual(self.told, [])
        for _ in range(2):
            self.now += 0.2
            self.look(["player", "vpdetector"])
        self.assertEqual(len(self.told), 1)
        self.assertIn("hears nothing of frontend, backend on udpm://here", self.told[0])

    def test_those_that_come_late_or_send_frames_are_heard(self):
        self.look([])
        self.now += 60
        self.look(["player", "vpdetector", "frontend", "backend"])
        self.hearing.look("no JSON", False)
        self.hearing.look('{"frame": 1}', False)
        self.look([], frames_come=True)
        self.look([])
        self.assertEqual(self.told, [])


class Urls(unittest.TestCase):
    def test_those_that_reach_no_other_process_are_refused(self):
        for url, expected in (("memq://", "reaches no other process"),
                              ("file://log.lcm", "reaches no other process"),
                              ("tcpq://localhost", "reaches no other process"),
                              ("udpm://127.0.0.1:7667?ttl=0", "127.0.0.1 is no multicast address"),
                              ("udpm://localhost:7667", "localhost is no multicast address")):
            with self.assertRaisesRegex(UserError, expected.replace(".", r"\.")):
                multicast.check_url(url)
        for url in ("udpm://", "udpm://:7668", "udpm://239.255.76.67:7667?ttl=0"):
            multicast.check_url(url)


class Errors(unittest.TestCase):
    def test_of_files_are_one_line_with_the_remedy(self):
        for path, expected in (("/proc/version/x", "/proc/version/x: Not a directory; check the path"),
                               ("/nowhere/x", "/nowhere/x: No such file or directory; check the")):
            with self.assertRaises(OSError) as caught:
                open(path, "w")
            self.assertIn(expected, errors.describe(caught.exception))
        full = OSError(28, "No space left on device", "map.ply")
        self.assertEqual(errors.describe(full), "map.ply: No space left on device; free space there")
        self.assertEqual(errors.describe(OSError("odd")), "odd")


if __name__ == "__main__":
    unittest.main()
