"""Processes that are started by hand, without the launcher: none waits for ever, and each says why
it ends."""

import json
import os
import pathlib
import re
import signal
import subprocess
import time
import unittest

import system

URL = "udpm://239.255.76.67:7719?ttl=0"
BIN = os.environ["VPSLAM_BIN_DIR"]
FRAMES = 40
PATIENCE_S = 200  # on a busy machine


class ByHand(system.SystemTest):
    def setUp(self):
        super().setUp()
        private = str(system.SOURCE / "tests" / "private_network")
        self.network_holder = subprocess.Popen([private, "sleep", "600"])
        self.addCleanup(self.network_holder.wait)
        self.addCleanup(self.network_holder.kill)
        self.processes = []
        self.addCleanup(self.kill_all)
        self.wait_until(lambda: b"sleep" in self.command_of(self.network_holder.pid), "a network")

    @staticmethod
    def command_of(pid):
        with open(f"/proc/{pid}/cmdline", "rb") as file:
            return file.read().split(b"\0")[0]

    def kill_all(self):
        for process in self.processes:
            process.kill()
            process.wait()
            process.stdout.close()

    def start_process(self, name, *arguments, url=URL):
        return self.start_inside(name, f"{BIN}/{name}", "--url", url, *arguments)

    def start_inside(self, name, *command):
        entrance = ["nsenter", "--user", "--net", "--preserve-credentials", "--target",
                    str(self.network_holder.pid)] if self.network else []
        process = subprocess.Popen(
            [*entrance, *map(str, command)], cwd=self.folder,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            env=dict(os.environ, TAG=self.tag))
        process.name = name
        self.processes.append(process)
        return process

    def end_of(self, process):
        output, _ = process.communicate(timeout=PATIENCE_S)
        return process.returncode, output

    def wait_until_it_takes_signals(self, process):
        """A process that waits for signals has them blocked (core/transport/process.cpp)."""
        def blocks_hangup():
            text = pathlib.Path(f"/proc/{process.pid}/status").read_text()
            return int(re.search(r"SigBlk:\s*([0-9a-f]+)", text).group(1), 16) & 1
        self.wait_until(blocks_hangup, f"the start of {process.name}")

    def wait_for_line(self, process, pattern):
        lines = []
        for line in process.stdout:
            lines.append(line)
            if re.search(pattern, line):
                return line
        self.fail(f"{process.name} said: {''.join(lines)}")

    def start_all_but_the_player(self, out):
        required = "frontend,backend,recorder,vpdetector"
        return [self.start_process("recorder", "--out", self.folder / out),
                self.start_process("backend"), self.start_process("vpdetector"),
                self.start_process("frontend", "--require", required)]

    def test_a_player_that_fails_at_the_start_ends_all(self):
        others = self.start_all_but_the_player("failed")
        player = self.start_process("player", self.folder / "nowhere")
        status, output = self.end_of(player)
        self.assertEqual(status, 1)
        self.assertIn("nowhere: does not exist", output)
        for process in others:
            with self.subTest(process.name):
                status, output = self.end_of(process)
                if process.name == "recorder":
                    self.assertEqual(status, 0, output)
                    self.assertIn("stopped before poses and map had ended", output)
                else:
                    self.assertEqual(status, 1, output)
                    self.assertIn("player failed: ", output)
                    self.assertEqual(output.count(" E "), 1, output)

    def test_hangup_ends_in_order(self):
        for process in self.start_all_but_the_player("hangup"):
            with self.subTest(process.name):
                self.wait_until_it_takes_signals(process)
                process.send_signal(signal.SIGHUP)
                status, output = self.end_of(process)
                self.assertEqual(status, 0, output)
                self.assertIn("stopping (SIGHUP)", output)

    def test_a_second_player_gives_way(self):
        others = self.start_all_but_the_player("second")
        first = self.start_process("player", system.sequence(), "--frames", FRAMES, "--require",
                                   "frontend,backend,recorder,vpdetector")
        self.wait_for_line(first, "playing")
        begin = time.monotonic()
        second = self.start_process("player", system.sequence())
        status, output = self.end_of(second)
        self.assertEqual(status, 1, output)
        self.assertIn(f"another player (pid {first.pid}) is at work on {URL}", output)
        self.assertLess(time.monotonic() - begin, 20)
        for process in [first, *others]:
            status, output = self.end_of(process)
            self.assertEqual(status, 0, process.name + output)
        summary = json.loads((self.folder / "second" / "summary.json").read_text())
        self.assertEqual(summary["frames"]["in"], FRAMES, "the first player's run suffered")
        self.assertEqual(summary["frames"]["dropped"], 0)

    def test_who_is_not_heard_is_named(self):
        backend = self.start_process("backend", url=URL.replace("7719", "7720"))
        frontend = self.start_process("frontend")
        player = self.start_process("player", system.sequence(), "--require", "frontend,backend")
        begin = time.monotonic()
        self.wait_for_line(player, r"waiting for backend on udpm://239.255.76.67:7719")
        self.wait_for_line(backend, r"nothing heard of player for \d+ s; start it with --url "
                                    r"'udpm://239.255.76.67:7720")
        self.assertLess(time.monotonic() - begin, 15)
        for process in (player, frontend, backend):
            begin = time.monotonic()
            process.send_signal(signal.SIGINT)
            status, output = self.end_of(process)
            self.assertEqual(status, 0, output)
            self.assertLess(time.monotonic() - begin, 3)

    def test_a_stream_that_does_not_answer_holds_up_no_end(self):
        server = self.start_inside(
            "server", "/usr/bin/python3", "-u", "-c",
            "import socket, time; server = socket.create_server(('127.0.0.1', 8123)); "
            "print('listens'); time.sleep(100)")
        self.wait_for_line(server, "listens")
        player = self.start_process("player", "http://127.0.0.1:8123/camera", "--camera",
                                    system.sequence() / "camera.yaml")
        self.wait_until_it_takes_signals(player)
        time.sleep(2)
        self.assertIsNone(player.poll(), "it waits for the server")
        begin = time.monotonic()
        player.send_signal(signal.SIGINT)
        status, output = self.end_of(player)
        self.assertEqual(status, 0, output)
        self.assertIn("stopped before the sequence was open", output)
        self.assertLess(time.monotonic() - begin, 3)

    def test_urls_that_reach_nobody_are_refused(self):
        for url, expected in (("memq://", "memq://: reaches no other process"),
                              ("file://log", "file://log: reaches no other process"),
                              ("udpm://127.0.0.1:7667", "127.0.0.1 is no multicast address")):
            for name in ("player", "backend"):
                with self.subTest(f"{name} {url}"):
                    arguments = [system.sequence()] if name == "player" else []
                    status, output = self.end_of(self.start_process(name, *arguments, url=url))
                    self.assertEqual(status, 1)
                    self.assertIn(expected, output)
                    self.assertEqual(output.count("\n"), 1, output)
            with self.subTest(f"vpslam {url}"):
                status, output = self.run_to_end(system.sequence(), "--url", url)
                self.assertEqual(status, 1)
                self.assertIn(expected, output)
                self.assertEqual(output.count("\n"), 1, output)


if __name__ == "__main__":
    unittest.main()
