"""What lines and vanishing points are worth, one step after the other, on every sequence."""

from vpslam_tools import install_build, presets
from vpslam_tools.benchmark import catalogue
from vpslam_tools.errors import UserError
from vpslam_tools.suites import sequences

NAME = "ablation"
HELP = ("what lines and vanishing points are worth: points, points+lines, and each step from there "
        "to the paper and to the default; seed 1 of each runs alone, for its times")
PACE = "lockstep"
AT_ONCE = 2
LINES = ["--preset", "points-lines"]
VARIANTS = {
    "points": ["--preset", "points"],
    "points+lines": LINES,
    "+ rotation paper": LINES + ["--rotation", "paper"],
    # It measures against the map's Manhattan frame, which bundle adjustment is then held to.
    "+ rotation fused": LINES + ["--rotation", "fused", "--manhattan", "on"],
    "+ translation paper": LINES + ["--translation", "paper"],
    "+ translation weighted": LINES + ["--translation", "weighted"],
    "paper": ["--preset", "paper"],
    "default": ["--preset", "default"],
}
REFERENCE, JUDGED = "points", "default"
SIMULATED = [each for each in catalogue.SIM if each.folder in ("sim:room", "sim:corridor")]


def run(args):
    if (args.pace or args.detectors or presets.given(args)
            or args.preset != presets.DEFAULT):
        raise UserError(f"--suite {NAME} chooses pace, detectors, presets and switches itself; "
                        "leave them out")
    args.pace = PACE
    install_build.prepare()
    # What needs numpy, which may have just been installed.
    from vpslam_tools.benchmark import ablation_report, discovery, runs
    found, missing = discovery.discover(catalogue.SHARED, args.data or sequences.shared_data())
    found += discovery.simulated(SIMULATED)
    if args.sequence:
        found, missing = sequences.select(found, missing, args.sequence)
    for each in missing:
        print(f"missing  {each.name}  ({each.folder})", flush=True)
    jobs = plan(found, args, runs)
    done = []
    for alone in (True, False):
        done += runs.run_jobs([job for job in jobs if (job.seed == 1) == alone],
                              lambda text: print(text, flush=True), 1 if alone else AT_ONCE)
    print(ablation_report.write(list(VARIANTS), REFERENCE, JUDGED, found, missing, done, args,
                                args.out))
    return 0 if all(run["status"] == "done" for run in done) else 1


def plan(found, args, runs):
    """Jobs, every variant of every sequence once before any twice."""
    jobs = []
    for seed in range(1, args.seeds + 1):
        for each in found:
            for variant, words in VARIANTS.items():
                options = sequences.options(args, words, pictures=False)
                folder = runs.folder_of(args.out / slug(variant), each, PACE, seed)
                jobs.append(runs.job_of(each, PACE, seed, options, folder, variant))
    return jobs


def slug(variant):
    """"+ rotation paper" -> "rotation-paper"; "points+lines" -> "points-lines"."""
    return "-".join(variant.replace("+", " ").split())
