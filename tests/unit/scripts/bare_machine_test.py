"""What `vpslam` can do before any package is installed: it has to install them."""

import pathlib
import subprocess
import sys
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parents[3] / "scripts"

WITHOUT_PACKAGES = """
import sys
for name in ("numpy", "matplotlib"):
    sys.modules[name] = None  # as if it were not installed
from vpslam_tools.cli import build_parser
build_parser()
"""


class BareMachine(unittest.TestCase):
    def test_all_commands_are_there_before_numpy_is(self):
        result = subprocess.run([sys.executable, "-s", "-c", WITHOUT_PACKAGES], text=True,
                                capture_output=True, cwd=SCRIPTS, check=False)
        self.assertEqual(result.returncode, 0, result.stderr)


if __name__ == "__main__":
    unittest.main()
