"""Presets and switches with the real processes, which log the settings in effect."""

import json
import unittest

import system

FRAMES = 8


class Presets(system.SystemTest):
    def start_with(self, *arguments):
        """Runs the first frames; the settings in effect, {process: text}."""
        out = self.folder / ("out" + "".join(arguments))
        status, output = self.run_to_end(system.sequence(), "--out", out, "--frames", FRAMES,
                                         *arguments)
        self.assertEqual(status, 0, output)
        self.assert_nothing_left()
        summary = json.loads((out / "summary.json").read_text())
        self.assertEqual(summary["frames"]["in"], FRAMES)
        self.options = summary["options"]
        return {path.stem: path.read_text() for path in (out / "logs").iterdir()}

    def assert_settings(self, logs, **expected):
        for process, settings in expected.items():
            for setting in settings:
                self.assertRegex(logs[process], rf"(?m)(^| ){setting}( |$)")

    def test_points(self):
        logs = self.start_with("--preset", "points")
        self.assertEqual(sorted(logs), sorted(system.WITHOUT_DETECTORS))
        self.assert_settings(
            logs, frontend=["lines.enabled=0", "rotation.mode=off", "translation=off",
                            "initializer.vps=0"],
            backend=["lines.enabled=0", "manhattan.enabled=0"])
        self.assertEqual(self.options["preset"], "points")

    def test_paper(self):
        logs = self.start_with("--preset", "paper")
        self.assertEqual(sorted(logs), sorted(system.NAMES))
        self.assert_settings(
            logs, frontend=["lines.enabled=1", "rotation.mode=paper", "translation=paper"],
            backend=["lines.enabled=1", "manhattan.enabled=0"],
            vpdetector1=["lines.detector.kind=lsd", "vps.method=two_line_grid"])

    def test_switches_over_a_preset_and_settings_over_switches(self):
        logs = self.start_with("--preset", "points-lines", "--manhattan", "on",
                               "--rotation", "fused", "--translation", "weighted", "--vp", "two_line_grid_raw",
                               "--vp-init", "on", "--set", "frontend.translation=off")
        self.assert_settings(
            logs, frontend=["lines.enabled=1", "rotation.mode=fused", "translation=off",
                            "initializer.vps=1"],
            backend=["lines.enabled=1", "manhattan.enabled=1"],
            vpdetector1=["vps.method=two_line_grid_raw"])
        self.assertEqual(self.options["rotation"], "fused")


if __name__ == "__main__":
    unittest.main()
