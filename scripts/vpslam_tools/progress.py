"""The progress line, from what the recorder prints: one JSON object a line."""

import json
import os
import shutil
import sys
import time

QUIET_S = 10.0  # between two lines where the output is not a terminal


class Progress:
    def __init__(self, stream=sys.stdout):
        self._stream = stream
        self._on_terminal = stream.isatty()
        self._line_open = False
        self._last_printed = -QUIET_S
        self._told = set()
        self.error = None  # why the recorder failed, by its own word

    def show(self, json_line):
        """Returns whether frames come through."""
        try:
            progress = json.loads(json_line)
            self.error = progress.get("error", self.error)
            line = describe(progress)
            messages = progress.get("messages", {}).items()
        except (ValueError, KeyError, TypeError, AttributeError):
            return False  # not a progress line; nothing hangs on it
        for process, message in messages:
            if (process, message) not in self._told:
                self._told.add((process, message))
                self.tell(f"{process}: {message}")
        if line is None:
            return False
        if self._on_terminal:
            width = shutil.get_terminal_size().columns - 1
            self._print("\r\033[K" + line[:width], end="")
            self._line_open = True
        elif time.monotonic() >= self._last_printed + QUIET_S:
            self._print(line)
            self._last_printed = time.monotonic()
        return True

    def tell(self, text):
        """Another line, in between."""
        if self._line_open:
            self._print("")
            self._line_open = False
        self._print(text)

    def _print(self, text, end="\n"):
        """Where nobody reads any more (`| head`, a closed terminal) the run goes on in silence."""
        try:
            print(text, end=end, file=self._stream, flush=True)
        except OSError:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self._stream.fileno())  # also for what Python still holds back
            os.close(nowhere)


def describe(progress):
    if progress["frame"] < 0:
        return None
    state = progress["state"]
    if progress.get("frames_lost", 0) > 0:
        state += f" for {progress['frames_lost']} frames"
    if progress.get("maps", 0) > 1:
        state += f"  map {progress['map']} ({progress['maps']} maps)"
    if progress.get("maps_merged", 0) > 0:
        state += f"  merged {progress['maps_merged']}"
    return (f"frame {progress['frame']}  {progress['fps']:.1f} fps  {state}  "
            f"keyframes {progress['keyframes']}  points {progress['points']}  "
            f"dropped {progress['dropped']}")
