"""Entry: `python3 scripts/vpslam_tools COMMAND ...`; scripts/vpslam calls it."""

import os
import sys

sys.path[0] = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))

from vpslam_tools.cli import main  # noqa: E402  (the path has to be set first)

sys.exit(main(sys.argv[1:]))
