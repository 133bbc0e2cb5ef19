"""What `vpslam bench` measures.

A suite has NAME, HELP (a line) and run(args), which gets --data (or None) and --out (a pathlib.Path
that exists) and returns the exit code. ARGUMENTS has the options beyond these two, by suite.
"""

from vpslam_tools.suites import ablation, detectors, micro, sequences, york

ALL = {suite.NAME: suite for suite in (*sequences.SUITES, ablation, york, detectors, micro)}
ARGUMENTS = {", ".join(suite.NAME for suite in (*sequences.SUITES, ablation)):
             sequences.add_arguments,
             york.NAME: york.add_arguments, detectors.NAME: detectors.add_arguments,
             micro.NAME: micro.add_arguments}
