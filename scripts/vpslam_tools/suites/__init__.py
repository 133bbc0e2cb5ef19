"""What `vpslam bench` measures: one module per suite.

Each has NAME, HELP (a line), add_arguments(group) for the options of its own, and run(args), which
gets --data (or None) and --out (a pathlib.Path that exists) and returns the exit code.
"""

from vpslam_tools.suites import detectors, york

ALL = {suite.NAME: suite for suite in (york, detectors)}
