"""A run is recorded, with nothing lost, and replayed, with the same result."""

import json
import pathlib
import subprocess
import unittest

import system

FRAMES = 60
STREAMS = {"TRUTH", "FEATURES", "POSE", "KEYFRAME", "MAP"}  # nothing of these may be missing


class Replay(system.SystemTest):
    def record(self, name, *arguments, **environment):
        out = self.folder / name
        status, output = self.run_to_end(system.sequence(), "--out", out, "--frames", FRAMES,
                                         "--seed", 3, *arguments, **environment)
        self.assertEqual(status, 0, output)
        self.assert_nothing_left()
        return out

    def replay(self, recorded, name, *arguments):
        out = self.folder / name
        status, output = self.run_to_end(recorded / "log.lcm", "--out", out, *arguments,
                                         command="replay")
        self.assertEqual(status, 0, output)
        self.assert_same_results(recorded, out)
        self.assert_nothing_left()
        return out

    def log(self, out):
        done = subprocess.run([system.VPSLAM, "log", out, "--json"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def assert_nothing_missing(self, out, streams):
        channels = self.log(out)["channels"]
        for name in streams:
            self.assertEqual((channels[name]["missing"], channels[name]["repeated"],
                              channels[name]["ended"]), (0, 0, 1), name)
        for name in streams & {"IMAGE", "FEATURES", "TRUTH"}:
            self.assertEqual(channels[name]["messages"], FRAMES + 1, name)  # with the end
        told = json.loads((out / "summary.json").read_text())["log"]
        self.assertTrue(told["complete"])
        self.assertEqual(sum(told["channels"][name]["gaps"] for name in streams), 0)

    def test_features(self):
        plain = self.record("plain", "--preset", "points")
        recorded = self.record("features", "--record", "features", "--preset", "points",
                               "--set", "frontend.orb.num_features=900")
        self.assertFalse((plain / "log.lcm").exists())
        self.assertNotEqual((plain / "trajectory.txt").read_bytes(),
                            (recorded / "trajectory.txt").read_bytes(), "settings matter")
        self.assert_nothing_missing(recorded, STREAMS)
        self.assertNotIn("IMAGE", self.log(recorded)["channels"])
        out = self.replay(recorded, "replayed_features")
        summary = json.loads((out / "summary.json").read_text())
        self.assertEqual(summary["seed"], 3)
        self.assertEqual(summary["options"]["set"], ["frontend.orb.num_features=900"])
        self.assertEqual((out / "truth.txt").read_bytes(), (recorded / "truth.txt").read_bytes())

    def test_images_and_lines_on_a_bad_network(self):
        recorded = self.record("all", "--record", "all", "--detectors", 1, **system.BAD_NETWORK)
        unrecorded = self.record("unrecorded", "--detectors", 1)
        self.assert_same_results(recorded, unrecorded)
        self.assert_nothing_missing(recorded, STREAMS | {"IMAGE"})
        self.replay(recorded, "replayed_images")
        self.replay(recorded, "replayed_features_and_lines", "--features")

    def test_what_is_no_log(self):
        broken = self.folder / "broken.lcm"
        broken.write_text("# rubbish")
        for path, expected in ((broken, "is no log of LCM messages"),
                               (self.folder / "nowhere", "no such file")):
            status, output = self.run_to_end(path, command="replay")
            self.assertEqual(status, 1)
            self.assertIn(expected, output)
            self.assertEqual(output.count("\n"), 1, output)
        self.assertFalse(pathlib.Path(self.folder / "results").exists())


if __name__ == "__main__":
    unittest.main()
