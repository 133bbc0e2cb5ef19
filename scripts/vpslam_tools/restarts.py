"""When a process that crashed is started again: a few times, a little later each time."""

import time

LIMIT = 3           # of restarts of one process within
WINDOW_S = 60.0     # this
DELAYS_S = [0.2, 1.0, 3.0]  # before the first, the second, the third of them


class Restarts:
    """Of the processes that a run can get back: the others take part in what only they know."""

    def __init__(self, names, clock=time.monotonic):
        self._names, self._clock = list(names), clock
        self._times = {}  # name: when it was started again, lately
        self._due = {}    # name: when it is to be started again

    def plan(self, name):
        """It crashed: True if it is to be started again, by due(). Asked again, says the same."""
        if name in self._due:
            return True
        now = self._clock()
        times = [at for at in self._times.get(name, []) if at > now - WINDOW_S]
        if name not in self._names or len(times) >= LIMIT:
            return False
        self._times[name] = times + [now]
        self._due[name] = now + DELAYS_S[min(len(times), len(DELAYS_S) - 1)]
        return True

    def count(self, name):
        """How often it was started again lately, the time that is planned included."""
        return len(self._times.get(name, []))

    def due(self):
        """Names of those whose time has come; each is told once."""
        now = self._clock()
        names = [name for name, at in self._due.items() if at <= now]
        for name in names:
            del self._due[name]
        return names

    def wait_s(self, longest_s):
        """How long one may sleep until the next is due."""
        now = self._clock()
        return min([longest_s, *(max(0.0, at - now) for at in self._due.values())])
