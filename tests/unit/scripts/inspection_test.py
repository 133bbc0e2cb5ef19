"""status, log, replay and keys, without processes: what they make of what `console` says."""

import argparse
import contextlib
import io
import pathlib
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))

from vpslam_tools import (console, errors, keyboard, log_command, multicast, registry,  # noqa: E402
                          replay_command, restarts, run_command, status_command)

STATUS = ('{{"process": "{process}", "session": "{session}", "pid": {pid}, "state": "{state}", '
          '"rate_hz": 29.97, "processed": 300, "queued": 1, "dropped": 2, "gaps": 3, '
          '"rejected": 4, "resent": 5, "cpu_s": 6.25, "rss_peak_mb": 70.4, "message": "{message}"}}')


def status(process="frontend", session=1, pid=42, state="running", message=""):
    return STATUS.format(process=process, session=session, pid=pid, state=state, message=message)


class Status(unittest.TestCase):
    def test_a_line_per_process_in_the_order_of_the_graph(self):
        table = status_command.Table()
        for session, name in enumerate(["recorder", "frontend", "vpdetector", "vpdetector",
                                        "player"]):
            table.add(status(name, session, pid=100 + session), 0.0)
        lines = status_command.describe(table.rows(0.0)).splitlines()
        self.assertEqual([line.split()[0] for line in lines],
                         ["process", "player", "vpdetector", "vpdetector", "frontend", "recorder"])
        self.assertEqual(lines[4].split(), ["frontend", "101", "running", "30.0", "300", "1", "2",
                                            "3", "4", "5", "6.2", "70"])
        self.assertEqual(len({line.find("running") for line in lines[1:]}), 1, "in columns")

    def test_the_newest_counts_and_silence_is_told(self):
        table = status_command.Table()
        table.add(status(state="ready"), 0.0)
        table.add(status(state="running", message="paused before frame 7"), 10.0)
        table.add('{"process": "cut o', 10.0)
        rows = table.rows(12.0)
        self.assertEqual([row["state"] for row in rows], ["running"])
        self.assertIn("paused before frame 7", status_command.describe(rows))
        self.assertNotIn("silent", status_command.describe(rows))
        self.assertIn("silent for 20 s", status_command.describe(table.rows(30.0)))
        self.assertEqual(table.rows(200.0), [])


class Watch(unittest.TestCase):
    def test_ends_with_the_graph_whatever_was_said_last(self):
        lines = [status("player", 1), status("frontend", 2), status("player", 1, state="finished"),
                 status("frontend", 2, state="finished")]
        said = subprocess.Popen(["/bin/sh", "-c", 'printf "%s\\n" "$@"; exec sleep 60', "sh", *lines],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(said.communicate)
        self.addCleanup(said.kill)
        shown = io.StringIO()
        with contextlib.redirect_stdout(shown):
            self.assertEqual(status_command.watch(said, as_json=False), 0)
        self.assertEqual(shown.getvalue().strip().splitlines()[-1].split()[2], "finished")


class Ports(unittest.TestCase):
    def test_graphs_are_kept_apart_by_them(self):
        self.assertEqual(multicast.port("udpm://239.255.76.67:7001?ttl=0"),
                         multicast.port("udpm://239.255.76.99:7001"))
        self.assertEqual(multicast.port("udpm://?ttl=0"), multicast.port("udpm://1.2.3.4:7667"))
        self.assertNotEqual(multicast.port("udpm://:1"), multicast.port("udpm://:2"))


class Keys(unittest.TestCase):
    def test_what_they_mean(self):
        keys = keyboard.Keys()
        self.assertEqual([keys.command(key) for key in "  .. +-0xq"],
                         ["pause", "resume", "step 1", "step 1", "resume", "rate 1", "rate 0.5",
                          "rate 0", None, "stop"])

    def test_rates_have_limits(self):
        keys = keyboard.Keys()
        for _ in range(20):
            fastest = keys.command("+")
        self.assertEqual(fastest, "rate 64")
        for _ in range(40):
            slowest = keys.command("-")
        self.assertEqual(slowest, "rate 0.015625")


class RestartLimits(unittest.TestCase):
    def setUp(self):
        self.now = 0.0
        self.restarts = restarts.Restarts(["frontend"], clock=lambda: self.now)

    def test_a_few_times_a_minute(self):
        for number in range(restarts.LIMIT):
            self.assertTrue(self.restarts.plan("frontend"))
            self.assertTrue(self.restarts.plan("frontend"), "asked again, the same answer")
            self.assertEqual(self.restarts.due(), [])
            self.assertLess(self.restarts.wait_s(100), 100)
            self.now += restarts.DELAYS_S[number] + 0.01
            self.assertEqual(self.restarts.due(), ["frontend"])
            self.assertEqual(self.restarts.due(), [])
        self.assertFalse(self.restarts.plan("frontend"))
        self.now += restarts.WINDOW_S
        self.assertTrue(self.restarts.plan("frontend"))
        self.assertFalse(self.restarts.plan("backend"))


SUMMARY = {"events": 10, "damaged_bytes": 0, "damaged_places": 0, "duration_s": 2.5,
           "camera": {"width": 640, "height": 480},
           "run": {"seed": 7, "commit": "abc", "options": {
               "sequence": "room", "set": ["frontend.orb.num_features=900"], "pace": "lockstep",
               "preset": "points", "detectors": 2, "camera": "mine.yaml", "frames": 100}},
           "channels": {"CAMERA": {"messages": 3, "missing": 0, "repeated": 0, "ended": 0,
                                   "bytes": 450},
                        "FEATURES": {"messages": 100, "missing": 1, "repeated": 2, "ended": 1,
                                     "bytes": 5200000},
                        "ACK": {"messages": 50, "missing": None, "repeated": None, "ended": 0,
                                "bytes": 500}}}


def replay_arguments(*words):
    parser = argparse.ArgumentParser()
    replay_command.add_parser(parser.add_subparsers())
    return parser.parse_args(["replay", *words])


class Replay(unittest.TestCase):
    def options(self, *words, channels=("CAMERA", "FEATURES")):
        summary = dict(SUMMARY, channels=dict.fromkeys(channels))
        return replay_command.run_options(replay_arguments("log.lcm", *words),
                                          pathlib.Path("log.lcm"), summary)

    def test_preset_settings_and_seed_are_those_of_the_recorded_run(self):
        options = self.options()
        self.assertEqual((options.seed, options.preset, options.pace), (7, "points", "lockstep"))
        self.assertEqual(options.set, ["frontend.orb.num_features=900"])
        self.assertEqual((options.sequence, options.source), ("log.lcm", "log"))
        self.assertIsNone(options.camera, "the log has it")
        self.assertIsNone(options.frames, "the log has no more")
        self.assertEqual(options.record, "none")

    def test_features_need_no_detectors_images_do(self):
        options = self.options()
        self.assertEqual((options.from_features, options.detectors), (True, 0))
        both = ("CAMERA", "FEATURES", "IMAGE")
        options = self.options(channels=both)
        self.assertEqual((options.from_features, options.detectors), (False, 2))
        options = self.options("--detectors", "1", channels=both)
        self.assertEqual(options.detectors, 1)
        self.assertTrue(self.options("--features", channels=both).from_features)

    def test_a_run_in_real_time_is_replayed_without_losses(self):
        realtime = dict(SUMMARY["run"]["options"], pace="realtime")
        for words, pace in (((), "lossless"), (("--pace", "realtime"), "realtime")):
            options = replay_command.run_options(
                replay_arguments("log.lcm", *words), pathlib.Path("log.lcm"),
                dict(SUMMARY, run=dict(SUMMARY["run"], options=realtime)))
            self.assertEqual(options.pace, pace)

    def test_a_preset_of_another_version(self):
        options = dict(SUMMARY["run"]["options"], preset="magic")
        summary = dict(SUMMARY, run=dict(SUMMARY["run"], options=options))
        with self.assertRaisesRegex(errors.UserError, "preset 'magic'"):
            replay_command.run_options(replay_arguments("log.lcm"), pathlib.Path("log.lcm"),
                                       summary)

    def test_a_log_without_frames(self):
        with self.assertRaisesRegex(errors.UserError, "neither images nor features"):
            self.options(channels=("CAMERA",))

    def test_a_log_of_another_logger_has_no_run(self):
        summary = dict(SUMMARY, run=None, channels={"IMAGE": None})
        options = replay_command.run_options(replay_arguments("log.lcm"), pathlib.Path("log.lcm"),
                                             summary)
        self.assertEqual((options.seed, options.detectors), (1, 1))


class Log(unittest.TestCase):
    def test_description(self):
        text = log_command.describe(SUMMARY)
        self.assertIn("seed 7, abc", text)
        self.assertIn("preset points", text)
        rows = {line.split()[0]: line.split()[1:] for line in text.splitlines()}
        self.assertEqual(rows["FEATURES"], ["100", "1", "2", "5.200"])
        self.assertEqual(rows["ACK"], ["50", "-", "-", "0.001"])
        self.assertNotIn("damaged", text)
        self.assertNotIn("cut off", text)

    def test_a_log_that_was_cut_off(self):
        features = dict(SUMMARY["channels"]["FEATURES"], ended=0)
        text = log_command.describe(dict(SUMMARY, damaged_bytes=99, damaged_places=2,
                                         channels={"FEATURES": features}))
        self.assertIn("damaged  99 bytes in 2 places", text)
        self.assertIn("cut off  FEATURES", text)


class WhichRun(unittest.TestCase):
    def setUp(self):
        self.runs = []
        before = registry.alive_runs
        registry.alive_runs = lambda: self.runs
        self.addCleanup(setattr, registry, "alive_runs", before)

    def test_the_only_one_or_the_one_that_is_named(self):
        self.assertEqual(console.find_url("udpm://x"), "udpm://x")
        with self.assertRaisesRegex(errors.UserError, "no run is going on"):
            console.find_url(None)
        self.runs.append({"url": "udpm://1", "sequence": "room"})
        self.assertEqual(console.find_url(None), "udpm://1")
        self.runs.append({"url": "udpm://2", "sequence": "desk"})
        with self.assertRaisesRegex(errors.UserError, "name one:\n.*udpm://1.*\n.*udpm://2"):
            console.find_url(None)


class RunOptions(unittest.TestCase):
    def test_settings_go_into_the_log_as_they_were(self):
        parser = argparse.ArgumentParser()
        run_command.add_parser(parser.add_subparsers())
        self.assertEqual(parser.parse_args(["run", "x"]).record, "none")
        self.assertEqual(parser.parse_args(["run", "x", "--record", "all"]).record, "all")


if __name__ == "__main__":
    unittest.main()
