"""What `vpslam bench` measures.

A suite has NAME, HELP (a line) and run(args), which gets --data (or None) and --out (a pathlib.Path
that exists) and returns the exit code. ARGUMENTS has the options beyond these two, by suite.
"""

from vpslam_tools.suites import ablation, detectors, micro, sequences, spread, york

ALL = {suite.NAME: suite for suite in (*sequences.SUITES, ablation, spread, york, detectors, micro)}
ARGUMENTS = {", ".join(suite.NAME for suite in (*sequences.SUITES, ablation, spread)):
             sequences.add_arguments,
             spread.NAME: spread.add_arguments,
             york.NAME: york.add_arguments, detectors.NAME: detectors.add_arguments,
             micro.NAME: micro.add_arguments}
