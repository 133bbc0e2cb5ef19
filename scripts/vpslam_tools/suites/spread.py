"""How far results scatter with first frame and seed, and whether one version is better than
another."""

import functools
import os
import pathlib
import re
import shutil
import signal
import subprocess
from dataclasses import dataclass

from vpslam_tools import install_build, paths, presets, run_command, sources
from vpslam_tools.benchmark import catalogue
from vpslam_tools.errors import UserError
from vpslam_tools.suites import sequences

NAME = "spread"
HELP = ("how far errors scatter: several first frames and seeds of each sequence, in one process in "
        "lockstep; and whether one version is better than another")
PROGRAM = "offline_slam"
PACE = "lockstep"
AT_ONCE = 2
DEFAULT_RUNS = 10
SIMULATED = [each for each in catalogue.SIM if each.folder in ("sim:room", "sim:corridor")]
SECTION = r"(?:frontend|backend|vpdetector)\."
SETTING = rf"{SECTION}[\w.]+=[^,]+(?:,(?!{SECTION})[^,]+)*"  # a comma may be part of the value


@dataclass(frozen=True)
class Side:
    """What is measured: a program with settings, and the folder for its runs."""
    program: pathlib.Path
    settings: tuple
    out: pathlib.Path


@dataclass(frozen=True)
class Against:
    """What --against names: one of the three."""
    results: pathlib.Path = None   # folder of an earlier bench
    program: pathlib.Path = None   # of another build
    settings: tuple = None         # for the same build


def add_arguments(group):
    group.add_argument("--runs", type=run_command.at_least(1), default=DEFAULT_RUNS, metavar="N",
                       help="so many of each sequence (default: 10, which are the first frames 0 to 4 "
                       "with two seeds)")
    group.add_argument("--against", metavar="BUILD_OR_SETTINGS",
                       help="compare with another build (a folder with bin/offline_slam), with the "
                       "results folder of an earlier bench of this suite, or with the same build "
                       "under SECTION.KEY=VALUE[,SECTION.KEY=VALUE]... or `defaults` instead of --set")


def run(args):
    check(args)
    against = parse_against(args.against) if args.against else Against()
    if against.results == args.out:
        raise UserError(f"--against {args.against}: is where this bench writes; name another folder "
                        "with --out")
    install_build.prepare()
    # What needs numpy, which may have just been installed.
    from vpslam_tools.benchmark import discovery, runs, spread_report
    found, missing = find(args, discovery)
    for each in missing:
        print(f"missing  {each.name}  ({each.folder})", flush=True)
    judged = Side(paths.binaries() / PROGRAM, tuple(presets.settings(args) + args.set), args.out)
    baseline = baseline_side(against, args)
    for side in filter(None, (judged, baseline)):
        if not side.program.is_file():
            raise UserError(f"{side.program}: no such program; build it with `scripts/vpslam build`")
    found = [on_disk(each, args.out, against.results, discovery) for each in found]
    jobs = [(job_of(each, side, number, args, runs), side)
            for number in range(args.runs) for each in found
            for side in filter(None, (judged, baseline))]
    report = spread_report.Report(args, jobs, judged, baseline, against.results)
    done = runs.run_jobs([job for job, _ in jobs], lambda line: print(line, flush=True), AT_ONCE,
                         report.add)
    print(f"\n{report.text()}\nresults  {args.out}")
    return 0 if all(run["status"] == "done" for run in done) else 1


def check(args):
    for name, value in (("--pace", args.pace), ("--detectors", args.detectors)):
        if value is not None:
            raise UserError(f"--suite {NAME} runs everything in one process in lockstep; leave "
                            f"{name} out")
    if args.seeds != 1:
        raise UserError(f"--suite {NAME} chooses the seeds itself; say how many runs with --runs")
    presets.check(args)
    for path in filter(None, (args.camera, args.config)):
        if not pathlib.Path(path).is_file():
            raise UserError(f"{path}: no such file; check --camera and --config")
    for setting in args.set:
        if not re.fullmatch(SETTING, setting):
            raise UserError(f"--set {setting}: write it as frontend.KEY=VALUE, backend.KEY=VALUE or "
                            "vpdetector.KEY=VALUE")


def parse_against(text):
    if text == "defaults":
        return Against(settings=())
    folder = pathlib.Path(text)
    if folder.is_dir():
        if (folder / "runs.csv").is_file():
            return Against(results=folder.resolve())
        if (folder / "bin" / PROGRAM).is_file():
            return Against(program=folder.resolve() / "bin" / PROGRAM)
        raise UserError(f"--against {text}: the folder has neither runs.csv of an earlier bench nor "
                        f"bin/{PROGRAM} of a build")
    if re.fullmatch(f"{SETTING}(?:,{SETTING})*", text):
        return Against(settings=tuple(re.findall(SETTING, text)))
    raise UserError(f"--against {text}: is no folder, and no settings either; write those as "
                    "backend.KEY=VALUE,frontend.KEY=VALUE")


def baseline_side(against, args):
    """None where there is none, or it was run before."""
    if against.program:
        return Side(against.program, tuple(presets.settings(args)),
                    args.out / "against" / against.program.parent.parent.parent.name
                    / against.program.parent.parent.name)
    if against.settings is not None:
        name = re.sub(r"[^\w.=-]+", "_", ",".join(against.settings) or "defaults")
        return Side(paths.binaries() / PROGRAM, tuple(presets.settings(args)) + against.settings,
                    args.out / "against" / name[:100])
    return None


def find(args, discovery):
    """([Found], [Sequence] that are missing), the simulated ones not yet rendered."""
    data = pathlib.Path(args.data) if args.data else sequences.shared_data()
    found, missing = [], catalogue.SHARED
    if args.data or data.is_dir():
        found, missing = discovery.discover(catalogue.SHARED, data)
    found += discovery.simulated(SIMULATED)
    return sequences.select(found, missing, args.sequence) if args.sequence else (found, missing)


def on_disk(found, out, earlier, discovery):
    """Simulated: rendered to files once; those of an earlier bench serve where it has them."""
    if not found.source.startswith("sim:"):
        return found
    name = sources.short_name(found.source)
    for folder in filter(None, (earlier and earlier / "sequences" / name, out / "sequences" / name)):
        if (folder / "rgb.txt").is_file():
            return discovery.Found(found.sequence, str(folder), discovery.count_frames(folder))
    print(f"rendering {found.source}", flush=True)
    unfinished = folder.with_name(folder.name + ".new")
    shutil.rmtree(unfinished, ignore_errors=True)
    unfinished.parent.mkdir(parents=True, exist_ok=True)
    command = [str(paths.binaries() / "player"), "--render", found.source, "--to", str(unfinished)]
    if subprocess.run(command, stdout=subprocess.DEVNULL).returncode != 0:
        raise UserError(f"{found.source} could not be rendered (see above)")
    from vpslam_tools.benchmark import runs
    # A text, and so a part of what tells whether two runs had the same input.
    (unfinished / "images.txt").write_text(
        runs.files_digest(sorted((unfinished / "rgb").iterdir())) + "\n")
    os.replace(unfinished, folder)
    return discovery.Found(found.sequence, str(folder), discovery.count_frames(folder))


def job_of(found, side, number, args, runs):
    """Run `number` of a sequence, from 0."""
    from vpslam_tools.benchmark import scores, spread
    start, seed = spread.start_and_seed(number)
    results = (side.out / "runs" / sources.short_name(found.sequence.folder)
               / f"start{start}-seed{seed}")
    camera = args.camera or sources.published_camera(found.source)
    options = ["--start", str(start), "--seed", str(seed)]
    for name, value in (("camera", camera), ("frames", args.frames), ("config", args.config)):
        options += [f"--{name}", str(value)] * bool(value)
    options += ["--no-detector"] * (presets.detectors(args) == 0)
    options += [word for setting in side.settings for word in ("--set", setting)]
    seen = runs.files_digest(runs.sequence_texts(found.source) + [pathlib.Path(args.camera or "")])
    frames = found.frames and max(0, found.frames - start)
    if frames and args.frames:
        frames = min(frames, args.frames)
    about = {"start": start, "settings": " ".join(side.settings), "seen": seen}
    key = {"command": options, "source": found.source, "inputs": seen,
           "programs": runs.files_digest([side.program]),
           "config": runs.files_digest([pathlib.Path(args.config or "")])}
    title = f"{found.sequence.name}, first frame {start}, seed {seed}"
    if side.out != args.out:
        title += ", baseline"
    return runs.Job(
        found, PACE, seed, results,
        [str(side.program), found.source, "--out", str(results), "--verbose", *options],
        frames or 600, title, about, key,
        score=functools.partial(scores.score, truth=pathlib.Path(found.source) / "groundtruth.txt",
                                least_frames=frames or 0),
        stop_signal=signal.SIGTERM, program=PROGRAM)
