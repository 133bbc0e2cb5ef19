"""Micro-benchmarks of the hot paths, by micro_bench, and their ratios to a stored baseline."""

import json
import pathlib
import subprocess

from vpslam_tools import install_build, multicast, paths
from vpslam_tools.errors import UserError

NAME = "micro"
HELP = "time of the hot paths one by one, and ratios to bench/micro/baseline.json; needs no data"
BASELINE = paths.ROOT / "bench" / "micro" / "baseline.json"
REPETITIONS = 5
TO_NS = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}
NOTABLE = 1.1  # slower by so much is marked


def add_arguments(group):
    group.add_argument("--filter", metavar="REGEX", help="only benchmarks whose name matches")
    group.add_argument("--baseline", metavar="FILE", default=str(BASELINE),
                       help="compare with this one (default: that of the source tree)")
    group.add_argument("--store-baseline", action="store_true",
                       help="write what was measured to the baseline")


def run(args):
    install_build.prepare()
    # What needs numpy, which may have just been installed.
    from vpslam_tools.benchmark.runs import write_json
    multicast.ensure_multicast()
    measured = measure(args)
    write_json(args.out / "micro.json", measured)
    baseline = read_baseline(args.baseline)
    text = describe(measured, baseline)
    print(text)
    (args.out / "micro.md").write_text(text + "\n")
    if args.store_baseline:
        write_json(pathlib.Path(args.baseline), measured)
        print(f"stored in {args.baseline}")
    return 0


def read_baseline(path):
    try:
        with open(path, encoding="utf-8") as file:
            baseline = json.load(file)
        return {"cpu": baseline["cpu"], "least_ns": dict(baseline["least_ns"])}
    except FileNotFoundError:
        return {"cpu": "none", "least_ns": {}}
    except (OSError, ValueError, KeyError, TypeError):
        raise UserError(f"{path}: is no baseline; remove it, and store one with --store-baseline"
                        ) from None


def measure(args):
    command = [str(paths.binaries() / "micro_bench"), "--benchmark_format=json",
               f"--benchmark_repetitions={REPETITIONS}", "--benchmark_min_time=0.1",
               "--benchmark_enable_random_interleaving=true"]
    command += [f"--benchmark_filter={args.filter}"] * bool(args.filter)
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    except OSError as error:
        raise UserError(f"{command[0]}: cannot be started ({error.strerror}); install "
                        "libbenchmark-dev and build it with `scripts/vpslam build`") from None
    try:
        output = json.loads(done.stdout)
    except ValueError:
        raise UserError("micro_bench failed (see above)") from None
    return {"cpu": cpu(), "least_ns": least_times(output)}


def least_times(output):
    """{name: ns}, in the order of the program: the least of the repetitions, which other load disturbs
    least. CPU time; where a benchmark waits for others, time of day."""
    found = {}
    order = ("family_index", "per_family_instance_index")
    for each in sorted(output["benchmarks"], key=lambda each: [each.get(key, 0) for key in order]):
        if each["run_type"] == "iteration" and not each.get("error_occurred"):
            name = each["run_name"]
            time = each["real_time" if name.endswith("/real_time") else "cpu_time"]
            found[name] = min(time * TO_NS[each["time_unit"]], found.get(name, float("inf")))
    return found


def cpu():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        return next((line.split(":", 1)[1].strip() for line in file
                     if line.startswith("model name")), "unknown")


def describe(measured, baseline):
    from vpslam_tools.benchmark.tables import markdown  # needs numpy, as above
    rows = []
    for name, ns in measured["least_ns"].items():
        before = baseline["least_ns"].get(name)
        ratio = "-" if not before else f"{ns / before:.2f}"
        if before and ns / before > NOTABLE:
            ratio = f"**{ratio}**"
        rows.append([name, microseconds(ns), microseconds(before) if before else "-", ratio])
    same = "the same" if baseline["cpu"] == measured["cpu"] else f"{baseline['cpu']}"
    return (markdown(["benchmark", "least (us)", "baseline (us)", "ratio"], rows)
            + f"\nLeast of {REPETITIONS}; CPU time, for /real_time time of day. {measured['cpu']}; "
            f"the baseline's processor: {same}. Bold: slower by more than "
            f"{100 * (NOTABLE - 1):.0f} %.")


def microseconds(ns):
    return f"{ns / 1000:.1f}"
