"""A process that outlives the launcher and cleans up after it, should it be killed.

It sleeps on a pipe whose other end only the launcher holds; the kernel closes that end however the
launcher dies. If the run is still registered then, the launcher could not clean up itself.
"""

import os
import signal

from vpslam_tools import registry


class Guardian:
    def __init__(self, session):
        reading, self._lifeline = os.pipe()  # not inherited by the processes of the run
        self._pid = os.fork()
        if self._pid != 0:
            os.close(reading)
            return
        status = 1
        try:
            os.close(self._lifeline)
            _guard(session, reading)
            status = 0
        finally:
            os._exit(status)

    def dismiss(self):
        """After the launcher has cleaned up."""
        os.close(self._lifeline)
        os.waitpid(self._pid, 0)


def _guard(session, reading):
    os.setsid()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    # Whoever waits for the launcher's output to end must not wait for the guardian.
    nothing = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1, 2):
        os.dup2(nothing, descriptor)
    os.read(reading, 1)
    run = registry.read(registry.path_of(session))
    if run:
        registry.clean_up(run)
