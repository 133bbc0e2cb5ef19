"""Keys that steer the player while a run goes on, where the launcher has a terminal."""

import os
import signal
import subprocess
import sys
import termios
import tty

from vpslam_tools import console
from vpslam_tools.processes import die_with_parent

HELP = "keys     space: pause, go on   .: one frame   + -: rate   0: no limit   q: end"
FASTEST, SLOWEST = 64.0, 1 / 64


class Keys:
    """What each key means, as commands of `console`."""

    def __init__(self):
        self._paused = False
        self._rate = 0.0  # times real time; 0: no limit

    def command(self, key):
        """None for a key without a meaning."""
        if key == " ":
            self._paused = not self._paused
            return "pause" if self._paused else "resume"
        if key == ".":
            self._paused = True
            return "step 1"
        if key in "+-":
            faster = 2.0 if key == "+" else 0.5
            rate = self._rate * faster if self._rate else 1.0
            self._rate = min(max(rate, SLOWEST), FASTEST)
            return f"rate {self._rate:g}"
        if key == "0":
            self._rate = 0.0
            return "rate 0"
        return {"q": "stop"}.get(key)


class Keyboard:
    """A context in which keys are heard; nothing happens where there is no terminal."""

    def __init__(self, url, supervisor, progress):
        self._supervisor, self._progress = supervisor, progress
        self._command = console.command_line("command", "--url", url)
        self._console = None
        self._listening = False
        self._keys = Keys()

    def __enter__(self):
        if not self._has_terminal():
            return self
        self._console = subprocess.Popen(self._command, stdin=subprocess.PIPE, text=True,
                                         stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                         start_new_session=True, preexec_fn=die_with_parent())
        self._before = termios.tcgetattr(sys.stdin)
        tty.setcbreak(sys.stdin, termios.TCSANOW)  # Ctrl-C still is a signal
        self._supervisor.watch(sys.stdin, self._on_input)
        self._listening = True
        self._progress.tell(HELP)
        return self

    def __exit__(self, *_):
        if self._console is None:
            return
        self._stop_listening()
        try:
            termios.tcsetattr(sys.stdin, termios.TCSANOW, self._before)
        except termios.error:
            pass  # the terminal has gone
        try:
            self._console.stdin.close()
        except OSError:
            pass
        try:
            self._console.wait(timeout=2)  # it ends with its input
        except subprocess.TimeoutExpired:
            self._console.kill()
            self._console.wait()

    @staticmethod
    def _has_terminal():
        try:
            return sys.stdin.isatty() and os.tcgetpgrp(sys.stdin.fileno()) == os.getpgrp()
        except (OSError, ValueError, AttributeError):
            return False

    def _stop_listening(self):
        if self._listening:
            self._supervisor.unwatch(sys.stdin)
            self._listening = False

    def _on_input(self):
        try:
            keys = os.read(sys.stdin.fileno(), 64)
        except OSError:
            keys = b""
        if not keys:
            self._stop_listening()  # the terminal has gone
        for key in keys.decode(errors="replace"):
            command = self._keys.command(key)
            if command is None:
                continue
            self._progress.tell(command)
            try:
                print(command, file=self._console.stdin, flush=True)
            except OSError:
                pass  # the console has gone; Ctrl-C still ends the run
            if command == "stop":
                signal.raise_signal(signal.SIGINT)
