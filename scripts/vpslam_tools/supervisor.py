"""Starts the processes of a graph, watches them, and lets none outlive the launcher.

A process that crashed (was killed by a signal) is started again where the run can go on with it;
restarts.py says how often.

The end is a cascade: the player ends with its sequence (or on SIGINT), and each process downstream
ends when it has worked off what the one before it sent. The supervisor only waits; it steps in
where a process fails, ends before its time, or does not end.
"""

import os
import selectors
import signal
import subprocess
import time

from vpslam_tools.processes import die_with_parent
from vpslam_tools.restarts import LIMIT, Restarts

DRAIN_S = 120.0      # from the player's end to the last process's
INTERRUPT_S = 30.0   # from Ctrl-C to the player's end
NOTHING_YET_S = 1.5  # from Ctrl-C to the end of a run in which no frame came through
CASCADE_S = 20.0     # from the end of a player that failed to the last process's
CAUSE_S = 1.0        # from the first failure to the player's, which may be its cause
OUT_OF_TURN_S = 5.0  # a process that ended, before the one upstream of it
TERMINATE_S = 5.0    # from SIGTERM to SIGKILL
RECORDER_S = 30.0    # the same for the recorder, which still writes the results
TICK_S = 0.5         # how often the limits above are looked at


class Child:
    def __init__(self, name, command, log_path, pipe_output, again=False):
        self.name, self.log_path = name, log_path
        self.ended_at = None
        with open(log_path, "ab" if again else "wb") as log:
            # A session of its own: Ctrl-C on the terminal reaches the launcher alone.
            self.popen = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stderr=log,
                stdout=subprocess.PIPE if pipe_output else log,
                start_new_session=True, preexec_fn=die_with_parent(waits_for_signals=True))

    def is_running(self):
        """Also notes the time of the end when it is first seen."""
        if self.ended_at is None and self.popen.poll() is not None:
            self.ended_at = time.monotonic()
        return self.ended_at is None

    def signal(self, number):
        if self.is_running():
            try:
                os.killpg(self.popen.pid, number)
            except ProcessLookupError:
                pass

    def how_it_failed(self):
        """None if it runs or ended well."""
        if self.is_running() or self.popen.returncode == 0:
            return None
        if self.popen.returncode < 0:
            return f"was killed by {signal.Signals(-self.popen.returncode).name}"
        return f"failed with exit code {self.popen.returncode}"

    def crashed(self):
        """It had no time to say why it ended."""
        return not self.is_running() and self.popen.returncode < 0


class Supervisor:
    """`order`: names from the source downstream; the first ends by itself, the last writes the
    results. `on_output` gets each line that the last one prints, and returns true once frames
    come through. Those in `sharing` do the same work: as long as one of them runs, the loss of
    another is only told (`tell` gets a line). Those in `restartable` are started again after a
    crash; `on_restart` gets name and new process id."""

    def __init__(self, order, on_output, sharing=(), tell=print, restartable=(),
                 on_restart=lambda name, pid: None):
        self.order, self.on_output, self.on_restart = order, on_output, on_restart
        self._restarts = Restarts(restartable)
        self._commands = {}
        self.sharing, self.tell = list(sharing), tell
        self.children = {}
        self.interrupts = 0
        self.faults = {}  # name of the process: what is wrong with it
        self._lost = set()  # of those in `sharing`
        self._told = set()  # crashes, by their time
        self.frames_come = False
        self._selector = selectors.DefaultSelector()
        self._unfinished_line = b""
        self._wakeup, writing = os.pipe()
        os.set_blocking(self._wakeup, False)
        os.set_blocking(writing, False)
        signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
        self._selector.register(self._wakeup, selectors.EVENT_READ, self._on_signal)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._count_interrupt)
        if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:  # as nohup has it
            signal.signal(signal.SIGHUP, self._count_interrupt)

    def _count_interrupt(self, *_):
        self.interrupts += 1

    def start(self, name, command, log_path):
        is_last = name == self.order[-1]
        child = Child(name, command, log_path, pipe_output=is_last)
        self.children[name] = child
        self._commands[name] = command
        if is_last:
            os.set_blocking(child.popen.stdout.fileno(), False)
            self._selector.register(child.popen.stdout, selectors.EVENT_READ, self._on_pipe)
        return child.popen.pid

    def watch(self, stream, on_input):
        """`on_input` is called whenever `stream` can be read, while run() waits."""
        self._selector.register(stream, selectors.EVENT_READ, on_input)

    def unwatch(self, stream):
        self._selector.unregister(stream)

    def run(self):
        """Returns when no process is left; `faults`, `interrupts` and `frames_come` say how it
        went."""
        player = self.children[self.order[0]]
        told_at = None
        while self._needed() and not self._find_faults() and self.interrupts < 2:
            deadline = None
            if self.interrupts == 1:
                if told_at is None:
                    told_at = time.monotonic()
                    player.signal(signal.SIGINT)
                deadline = told_at + INTERRUPT_S
                if not self.frames_come and time.monotonic() > told_at + NOTHING_YET_S:
                    break  # there is nothing to wait for
            if not player.is_running():
                deadline = player.ended_at + DRAIN_S
            if deadline is not None and time.monotonic() > deadline:
                self.faults[self._needed()[0].name] = "did not end in time"
                break
            self._start_again()
            self._wait(self._restarts.wait_s(TICK_S))
        if not self._needed():
            self._find_faults()  # all may have ended since the last look
        self._find_cause()
        if self.frames_come and (player.popen.returncode or 0) > 0:
            # A source that broke down half-way still ended its stream: let it be worked off.
            deadline = player.ended_at + CASCADE_S
            while self._needed() and time.monotonic() < deadline and self.interrupts < 2:
                self._wait(TICK_S)
        self.stop()

    def stop(self):
        """Ends what still runs, the one that writes the results last."""
        last = self.children.get(self.order[-1])
        if self.interrupts < 2:
            self._terminate([child for child in self._running() if child is not last], TERMINATE_S)
            self._terminate(self._running(), RECORDER_S)
        else:
            self._terminate(self._running(), TERMINATE_S)
        self._wait(0)  # the last output

    def _terminate(self, children, patience_s):
        """A second interrupt ends the patience; the first one is what ends a run in order."""
        interrupts = max(self.interrupts, 1)
        deadline = time.monotonic() + patience_s
        for child in children:
            child.signal(signal.SIGTERM)
        while any(child.is_running() for child in children):
            if time.monotonic() > deadline or self.interrupts > interrupts:
                for child in children:
                    child.signal(signal.SIGKILL)
            self._wait(TICK_S)

    def _running(self):
        """In the order of the graph."""
        return [self.children[name] for name in self.order
                if name in self.children and self.children[name].is_running()]

    def _needed(self):
        """Those whose end is waited for: when they have gone, none has work for `sharing`."""
        return [child for child in self._running() if child.name not in self.sharing]

    def _find_faults(self):
        needed = self._needed()
        for position, name in enumerate(self.order):
            child = self.children[name]
            if child.is_running():
                continue
            fault = child.how_it_failed()
            upstream = [other for other in needed if other.name in self.order[:position]]
            if (fault is None and upstream
                    and time.monotonic() > child.ended_at + OUT_OF_TURN_S):
                fault = f"ended while {upstream[0].name} was still running"
            if fault and self._get_back(name, fault):
                continue
            if fault and self._restarts.count(name) == LIMIT:
                fault += ", again and again"
            if fault and not self._can_do_without(name, fault):
                self.faults[name] = fault
        return self.faults

    def _find_cause(self):
        """Who hears that the player failed may end before it does: the player gets a moment to end,
        and what failed upstream is told first."""
        player = self.children[self.order[0]]
        if not self.faults or player.name in self.faults or self.interrupts:
            return
        deadline = time.monotonic() + CAUSE_S
        while player.is_running() and time.monotonic() < deadline:
            self._wait(TICK_S)
        self._find_faults()
        self.faults = {name: self.faults[name] for name in self.order if name in self.faults}

    def _get_back(self, name, fault):
        """Plans to start it again, if that makes sense: as long as there is something to come."""
        child = self.children[name]
        player = self.children[self.order[0]]
        if not child.crashed() or not player.is_running() or self.interrupts:
            return False
        if not self._restarts.plan(name):
            return False
        if child.ended_at not in self._told:
            self._told.add(child.ended_at)
            self.tell(f"{name} {fault}; it is started again "
                      f"({self._restarts.count(name)} of at most {LIMIT} times a minute)")
        return True

    def _start_again(self):
        for name in self._restarts.due():
            log_path = self.children[name].log_path
            self.children[name] = Child(name, self._commands[name], log_path, pipe_output=False,
                                        again=True)
            self.on_restart(name, self.children[name].popen.pid)

    def _can_do_without(self, name, fault):
        others = [other for other in self.sharing
                  if other != name and self.children[other].is_running()]
        if name in self.sharing and others and name not in self._lost:
            self._lost.add(name)
            self.tell(f"{name} {fault}; the run goes on with {' and '.join(others)}")
        return name in self._lost

    # --- events

    def _wait(self, timeout_s):
        """Until a process ends, prints or a signal comes, at most timeout_s."""
        for key, _ in self._selector.select(timeout_s):
            key.data()

    def _on_signal(self):
        try:
            os.read(self._wakeup, 4096)
        except BlockingIOError:
            pass

    def _on_pipe(self):
        pipe = self.children[self.order[-1]].popen.stdout
        try:
            data = os.read(pipe.fileno(), 65536)
        except BlockingIOError:
            return
        if not data:
            self._selector.unregister(pipe)
            return
        lines = (self._unfinished_line + data).split(b"\n")
        self._unfinished_line = lines.pop()
        for line in lines:
            self.frames_come |= self.on_output(line.decode(errors="replace"))
