#!/usr/bin/python3
"""Stands in for player, vpdetector, frontend, backend or recorder, by whose name it is called.

Each waits for a file that the one upstream leaves in its working directory when it ends. The
environment variable FAKE_<NAME> makes one misbehave: "fail" (after it printed a line), "hang"
(ignores SIGTERM and never ends), "early" (ends well, before its turn), "break" (player: ends its
stream, but fails), "crash" (is killed by a signal as soon as it has begun), "deaf" (recorder:
nothing comes to it).
"""

import os
import pathlib
import shutil
import signal
import sys
import time

NAME = os.path.basename(sys.argv[0])
MISBEHAVIOUR = os.environ.get("FAKE_" + NAME.upper())
UPSTREAM = {"vpdetector": "player", "frontend": "player", "backend": "frontend", "recorder": "backend"}.get(NAME)


def option(flag):
    return sys.argv[sys.argv.index(flag) + 1]


stopped = []
for number in (signal.SIGINT, signal.SIGTERM):
    signal.signal(number, lambda *_: stopped.append(1))
signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
if NAME == "player":
    pathlib.Path(f"/dev/shm/vpslam-{option('--session')}").write_text("pixels")
print(f"fake {NAME} begins", file=sys.stderr, flush=True)
pathlib.Path(NAME + ".began").touch()

if MISBEHAVIOUR == "fail":
    # Not before the recorder can be told to end, however slowly that starts.
    patience = time.monotonic() + 20
    while not os.path.exists("recorder.began") and time.monotonic() < patience:
        time.sleep(0.02)
    print("cannot read the stars; clean the lens", file=sys.stderr, flush=True)
    sys.exit(3)
if MISBEHAVIOUR == "crash":
    os.kill(os.getpid(), signal.SIGKILL)
if MISBEHAVIOUR == "early":
    sys.exit(0)

end = time.monotonic() + float(os.environ.get("FAKE_SECONDS", "0.3"))
frame = 0
while MISBEHAVIOUR == "hang" or not stopped:
    if NAME == "player" and time.monotonic() > end and MISBEHAVIOUR != "hang":
        break
    if UPSTREAM and os.path.exists(UPSTREAM + ".done") and MISBEHAVIOUR != "hang":
        break
    if NAME == "recorder" and MISBEHAVIOUR == "deaf":
        print('{"frame": -1, "processes": {}}', flush=True)
    elif NAME == "recorder":
        print('{"frame": %d, "fps": 29.5, "state": "tracking", "keyframes": 4, "points": 321, '
              '"dropped": 0, "processes": {}, "messages": {"player": "the lens is dirty"}}' % frame,
              flush=True)
        frame += 1
    time.sleep(0.02)

if NAME == "player":
    shutil.copy(os.path.join(sys.argv[1], "groundtruth.txt"), option("--truth"))
    os.unlink(f"/dev/shm/vpslam-{option('--session')}")
if NAME == "recorder" and MISBEHAVIOUR != "deaf":
    print(f"ends {'when stopped' if stopped else 'by itself'}", file=sys.stderr)
    out = pathlib.Path(option("--out"))
    (out / "trajectory.txt").write_text("0.0 0 0 0 0 0 0 1\n0.1 2 0 0 0 0 0 1\n0.2 2 2 0 0 0 0 1\n")
    (out / "summary.json").write_text('{"frames": {"in": 4, "tracked": 3, "dropped": 0}}')
pathlib.Path(NAME + ".done").touch()
sys.exit(4 if MISBEHAVIOUR == "break" else 0)
