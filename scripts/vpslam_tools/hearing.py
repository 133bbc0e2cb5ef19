"""Whether the processes of a graph hear each other, by what the recorder says of those it hears."""

import json
import time

PATIENCE_S = 5.0  # each speaks as soon as it has begun, and once a second from then on


class Hearing:
    """`programs`: of the graph; `tell` gets one line if some of them are not heard in time."""

    def __init__(self, programs, url, tell, clock=time.monotonic):
        self._programs, self._url, self._tell, self._clock = programs, url, tell, clock
        self._since = None
        self._done = False

    def look(self, json_line, frames_come):
        """At each line that the recorder prints."""
        self._done |= frames_come
        if self._done:
            return
        self._since = self._since or self._clock()
        try:
            heard = json.loads(json_line)["processes"]
        except (ValueError, KeyError, TypeError):
            return
        unheard = [name for name in self._programs if name not in heard and name != "recorder"]
        if unheard and self._clock() > self._since + PATIENCE_S:
            self._done = True
            self._tell(f"the recorder hears nothing of {', '.join(unheard)} on {self._url}; does a "
                       "firewall keep UDP from 224.0.0.0/4? (Ctrl-C ends the run)")
