"""Presets, the switches over them, and the user's own settings over both."""

import argparse
import json
import pathlib
import sys
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(SOURCE / "scripts"))
from vpslam_tools import demo_command, presets, processes, run_command  # noqa: E402
from vpslam_tools.errors import UserError  # noqa: E402


def parse(*words):
    parser = argparse.ArgumentParser()
    run_command.add_parser(parser.add_subparsers())
    args = parser.parse_args(["run", "sim:room", *words])
    if args.detectors is None:
        args.detectors = presets.detectors(args)
    return args


def settings_in_effect(*words):
    """{key: value} that the last of the repeated --set words leaves, as the processes read them."""
    commands = processes.command_lines(parse(*words), "url", "1", pathlib.Path("out"))
    found = [command for name, command in commands.items() if name not in ("player", "recorder")]
    each = [[command[i + 1] for i, word in enumerate(command) if word == "--set"]
            for command in found]
    assert all(other == each[0] for other in each)
    return dict(setting.split("=", 1) for setting in each[0])


def told(*words):
    command = processes.command_lines(parse(*words), "url", "1", pathlib.Path("out"))["recorder"]
    return json.loads(command[command.index("--options") + 1])


class Presets(unittest.TestCase):
    def test_default_sets_nothing(self):
        self.assertEqual(settings_in_effect(), {})
        self.assertEqual(parse().detectors, 1)

    def test_points_uses_neither_lines_nor_vanishing_points(self):
        settings = settings_in_effect("--preset", "points")
        for key in ("frontend.lines.enabled", "backend.lines.enabled", "backend.manhattan.enabled",
                    "frontend.initializer.vps"):
            self.assertEqual(settings[key], "false", key)
        self.assertEqual(settings["frontend.rotation.mode"], "off")
        self.assertEqual(settings["frontend.translation"], "off")
        self.assertEqual(parse("--preset", "points").detectors, 0)

    def test_points_and_lines_differ_in_lines_alone(self):
        points, lines = (settings_in_effect("--preset", name)
                         for name in ("points", "points-lines"))
        self.assertEqual({key for key in points if points[key] != lines[key]},
                         {"frontend.lines.enabled", "backend.lines.enabled"})
        self.assertEqual(parse("--preset", "points-lines").detectors, 1)

    def test_paper(self):
        settings = settings_in_effect("--preset", "paper")
        for key, value in (("vpdetector.lines.detector.kind", "lsd"),
                           ("vpdetector.vps.method", "two_line_grid"),
                           ("frontend.lines.enabled", "true"), ("frontend.rotation.mode", "paper"),
                           ("frontend.translation", "paper"),
                           ("backend.manhattan.enabled", "false"),
                           ("frontend.initializer.vps", "false")):
            self.assertEqual(settings[key], value, key)

    def test_switch_over_preset_and_setting_over_switch(self):
        words = ["--preset", "paper", "--translation", "weighted"]
        self.assertEqual(settings_in_effect(*words)["frontend.translation"], "weighted")
        words += ["--set", "frontend.translation=off"]
        self.assertEqual(settings_in_effect(*words)["frontend.translation"], "off")
        self.assertEqual(settings_in_effect(*words)["frontend.rotation.mode"], "paper")

    def test_a_switch_alone_sets_its_own_settings_only(self):
        self.assertEqual(settings_in_effect("--lines", "off"),
                         {"frontend.lines.enabled": "false", "backend.lines.enabled": "false"})

    def test_every_switch_is_settled_by_the_presets_that_name_any(self):
        for name in ("points", "points-lines", "paper"):
            missing = set(presets.SWITCHES) - set(presets.PRESETS[name])
            self.assertLessEqual(missing, {"vp"}, name)

    def test_detectors_follow_what_is_switched_on(self):
        for words, expected in ((["--preset", "points", "--manhattan", "on"], 1),
                                (["--preset", "points", "--rotation", "paper"], 1),
                                (["--preset", "points", "--translation", "paper"], 0),
                                (["--preset", "points-lines", "--lines", "off"], 0),
                                (["--preset", "points", "--vp-init", "on"], 1),
                                (["--preset", "points", "--detectors", "2"], 2)):
            self.assertEqual(parse(*words).detectors, expected, words)

    def test_the_summary_is_told(self):
        told_options = told("--preset", "paper", "--rotation", "off", "--vp", "three_line")
        self.assertEqual(told_options["preset"], "paper")
        self.assertEqual(told_options["rotation"], "off")
        self.assertEqual(told_options["vp"], "three_line")
        self.assertEqual(told_options["detectors"], 1)
        self.assertNotIn("lines", told_options)
        self.assertEqual(told()["preset"], "default")

    def test_what_would_have_no_effect_is_refused(self):
        with self.assertRaisesRegex(UserError, "--manhattan on"):
            presets.check(parse("--preset", "points-lines", "--rotation", "fused"))
        presets.check(parse("--preset", "points-lines", "--rotation", "fused", "--manhattan", "on"))
        presets.check(parse("--rotation", "fused"))

    def test_words_say_the_same(self):
        words = ["--preset", "paper", "--lines", "off", "--vp", "three_line",
                 "--vp-init", "on"]
        self.assertEqual(presets.words(parse(*words)), words)

    def test_demo_passes_them_on(self):
        parser = argparse.ArgumentParser()
        demo_command.add_parser(parser.add_subparsers())
        args = demo_command.run_options(
            parser.parse_args(["demo", "--preset", "points", "--lines", "on"]), "out")
        self.assertEqual((args.preset, args.lines, args.rotation), ("points", "on", None))


if __name__ == "__main__":
    unittest.main()
