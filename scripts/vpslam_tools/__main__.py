"""Entry: `python3 scripts/vpslam_tools COMMAND ...`; scripts/vpslam calls it."""

import os
import signal
import sys

INTERRUPTED = 130

# Nothing has begun that would have to be cleaned up, and an exception could come in any import.
signal.signal(signal.SIGINT, lambda *_: os._exit(INTERRUPTED))
signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])  # scripts/vpslam blocks it

sys.path[0] = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))

from vpslam_tools.cli import main  # noqa: E402  (the path has to be set first)

try:
    signal.signal(signal.SIGINT, signal.default_int_handler)
    code = main(sys.argv[1:])
except KeyboardInterrupt:
    code = INTERRUPTED
# All is done; the interpreter's own end could be interrupted as well.
signal.signal(signal.SIGINT, signal.SIG_IGN)
sys.exit(code)
