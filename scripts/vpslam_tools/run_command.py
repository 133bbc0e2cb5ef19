"""`vpslam run`: the whole graph on one sequence."""

import argparse
import datetime
import itertools
import json
import os
import pathlib
import random
import re
import sys

from vpslam_tools import install_build, multicast, outcome, presets, processes, registry, sources
from vpslam_tools.errors import UserError
from vpslam_tools.evaluate_command import evaluate_files
from vpslam_tools.guardian import Guardian
from vpslam_tools.hearing import Hearing
from vpslam_tools.keyboard import Keyboard
from vpslam_tools.progress import Progress
from vpslam_tools.supervisor import Supervisor

LOG_LINES_TOLD = 6
INTERRUPTED = 130
PACES = ["lockstep", "lossless", "realtime"]


def at_least(smallest):
    def parse(text):
        if not text.isdecimal() or int(text) < smallest:
            raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from {smallest} on")
        return int(text)
    return parse


def add_parser(commands):
    parser = commands.add_parser(
        "run", help="run the process graph on a sequence",
        description="Launches player, vpdetector, frontend, backend and recorder as processes of "
        "their own on an LCM URL with a port of its own. Ends when the sequence does; Ctrl-C ends "
        "it early, with results, and a second one at once.")
    sources.add_arguments(parser)
    parser.add_argument("--out", metavar="DIR",
                        help="results folder; default: results/DATE-SEQUENCE")
    parser.add_argument("--config", metavar="FILE", help="settings, such as config/default.yaml")
    parser.add_argument("--set", metavar="SECTION.KEY=VALUE", action="append", default=[],
                        help="one setting, over those of the file; may be repeated")
    parser.add_argument("--pace", choices=PACES, default="lockstep",
                        help="lockstep (default): nothing is dropped, results repeat exactly; "
                        "lossless: nothing is dropped, mapping beside tracking; realtime: the "
                        "tempo of the time stamps, a process that is too slow misses frames")
    parser.add_argument("--inline", action="store_true",
                        help="pixels in the messages instead of in shared memory")
    parser.add_argument("--start", type=at_least(0), metavar="N", help="first frame, from 0")
    parser.add_argument("--frames", type=at_least(1), metavar="N", help="at most so many frames")
    parser.add_argument("--seed", type=at_least(0), default=1, metavar="N",
                        help="of the random numbers (default: 1)")
    presets.add_arguments(parser)
    parser.add_argument("--detectors", type=at_least(0), metavar="N",
                        help="processes that find lines and vanishing points, which share the "
                        "images (default: 1, without lines and vanishing points 0)")
    parser.add_argument("--record", choices=["none", "features", "all"], default="none",
                        help="log the run's messages in DIR/log.lcm, for `vpslam replay`: features "
                        "(all but pixels), all (with pixels)")
    add_graph_arguments(parser)
    parser.set_defaults(function=run)


def add_graph_arguments(parser):
    """Those that `replay` has as well."""
    parser.add_argument("--preview", action="store_true",
                        help="publish PREVIEW all the time, not only while `vpslam spy` runs")
    parser.add_argument("--url", metavar="URL", help="LCM URL; default: one with a free port")
    parser.add_argument("--session", type=at_least(1), metavar="N",
                        help="id of the run, in the player's messages and the name of its shared "
                        "memory; default: a random one")


def run(args):
    check_input(args)
    if args.camera is None and args.source in (None, "tum"):
        args.camera = sources.published_camera(args.sequence)
    if args.detectors is None:
        args.detectors = presets.detectors(args)
    return run_graph(args)


def run_graph(args):
    if args.url:
        multicast.check_url(args.url)
    install_build.prepare()
    registry.sweep()
    url = args.url or multicast.free_url()
    multicast.ensure_multicast()
    refuse_port_in_use(url)
    out = pathlib.Path(args.out).resolve() if args.out else make_default_out(args.sequence)
    logs = out / "logs"
    refuse_folder_in_use(args, out)
    try:
        logs.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise cannot_be_made(out, error) from None
    # Of an earlier run: the one marks complete results; the other is not this run's log.
    (out / "summary.json").unlink(missing_ok=True)
    if (out / "log.lcm").exists():
        (out / "log.lcm").replace(out / "log.lcm.old")
    session = str(args.session or random.SystemRandom().randrange(1, 1 << 62))
    run_record = {"session": session, "url": url, "sequence": args.sequence,
                  "out": str(out), "started": datetime.datetime.now().isoformat("T", "seconds"),
                  "launcher": registry.identify(os.getpid()), "processes": {}}
    commands = processes.command_lines(args, url, session, out)
    progress = Progress()
    progress.tell(f"LCM URL  {url}")
    supervisor = launch(run_record, commands, processes.detectors(args), logs, progress, url)
    return conclude(supervisor, args, out, progress)


def refuse_port_in_use(url):
    """Two graphs on one port would hear each other."""
    for run in registry.alive_runs():
        if multicast.port(run["url"]) == multicast.port(url):
            raise UserError(f"--url {url}: a run on {run['sequence']} uses its port; name another, "
                            "or leave --url out")


def refuse_folder_in_use(args, out):
    """Two graphs would overwrite each other's results."""
    for run in registry.alive_runs():
        if run["out"] == str(out):
            raise UserError(f"{out}: a run on {run['sequence']} writes there; name another folder "
                            "with --out")
    if pathlib.Path(args.sequence).resolve() == out / "log.lcm":
        raise UserError(f"{out}: holds the log that is to be played; name another folder with "
                        "--out")


def check_input(args):
    """What would only come out when the processes are up; the rest they check themselves."""
    sources.check(args)
    presets.check(args)
    for option in ("camera", "config", "mask"):
        path = getattr(args, option)
        if path and not pathlib.Path(path).is_file():
            raise UserError(f"{path}: no such file; check --{option}")
    for setting in args.set:
        if not re.match(r"(frontend|backend|vpdetector)\.[\w.]+=.", setting):
            raise UserError(f"--set {setting}: write it as frontend.KEY=VALUE, "
                            "backend.KEY=VALUE or vpdetector.KEY=VALUE")


def cannot_be_made(folder, error):
    return UserError(f"{folder}: cannot be made ({error.strerror}); name another folder with --out")


def make_default_out(sequence):
    """A new folder: of runs that start in the same second, each gets its own."""
    stamp = datetime.datetime.now().strftime("%Y-%m-%d_%H%M%S")
    name = f"{stamp}-{sources.short_name(sequence)}"
    path = pathlib.Path("results", name).resolve()
    for repeat in itertools.count(2):
        try:
            path.mkdir(parents=True)
            return path
        except FileExistsError:
            path = path.with_name(f"{name}-{repeat}")
        except OSError as error:
            raise cannot_be_made(path, error) from None


def launch(run_record, commands, detectors, logs, progress, url):
    order = list(commands)
    hearing = Hearing(list(dict.fromkeys(pathlib.Path(command[0]).name
                                         for command in commands.values())), url, progress.tell)

    def register(name, pid):
        run_record["processes"][name] = registry.identify(pid) or {"pid": pid, "start": 0}
        registry.write(run_record)

    def on_output(line):
        frames_come = progress.show(line)
        hearing.look(line, frames_come)
        return frames_come

    # From here on a signal is counted by the supervisor, and raises no exception.
    supervisor = Supervisor(order, on_output, sharing=detectors, tell=progress.tell,
                            restartable=[*detectors, "frontend"], on_restart=register)
    registry.write(run_record)
    guardian = Guardian(run_record["session"])
    try:
        for name in reversed(order):
            if supervisor.interrupts:
                return supervisor
            try:
                pid = supervisor.start(name, commands[name], logs / f"{name}.log")
            except OSError as error:
                raise cannot_be_started(commands[name][0], error) from None
            register(name, pid)
        with Keyboard(url, supervisor, progress):
            supervisor.run()
    finally:
        supervisor.stop()
        registry.clean_up(run_record)
        guardian.dismiss()
    return supervisor


def cannot_be_started(program, error):
    if error.filename and pathlib.Path(error.filename).name != pathlib.Path(program).name:
        return UserError(f"{error.filename}: cannot be written ({error.strerror}); name another "
                         "folder with --out")
    return UserError(f"{program}: cannot be started ({error.strerror}); build it with "
                     "`scripts/vpslam build`")


def conclude(supervisor, args, out, progress):
    """Says how it went; the exit code."""
    for name, fault in supervisor.faults.items():
        log = supervisor.children[name].log_path
        progress.tell(f"{name} {fault}; {log} ends:")
        lines = log.read_text(errors="replace").splitlines()[-LOG_LINES_TOLD:]
        if name == "recorder" and progress.error and progress.error not in "\n".join(lines):
            lines.append(progress.error)  # its disk is full, and that of its log as well
        progress.tell("\n".join("  " + line for line in lines) or "  (empty)")
    path = out / "summary.json"
    summary = json.loads(path.read_text()) if path.exists() else {"frames": {"in": 0}}
    if supervisor.interrupts and path.exists():
        note_interruption(path, summary)
    frames = summary["frames"]
    if frames["in"] > 0:
        progress.tell(describe_results(out, summary))
    elif not supervisor.faults:
        lines = outcome.lines(summary) if "sequence" in summary else []
        progress.tell("\n".join(lines + [f"no frame came through; the logs are in {out / 'logs'}"]))
    if supervisor.faults:
        return 1
    # A first Ctrl-C ends a run in order, and leaves results; unless there was nothing yet.
    in_order = supervisor.interrupts == 0 or supervisor.interrupts == 1 and frames["in"] > 0
    return 0 if in_order else INTERRUPTED


def note_interruption(path, summary):
    """Not in place: the disk may be full, and what is there is worth more than the note."""
    new = path.with_name(".summary.json.new")
    try:
        new.write_text(json.dumps(dict(summary, interrupted=True), indent=2) + "\n")
        new.replace(path)
    except OSError as error:
        new.unlink(missing_ok=True)
        print(f"vpslam run: {path}: cannot note the interruption ({error.strerror})",
              file=sys.stderr)


def describe_results(out, summary):
    lines = outcome.lines(summary)
    truth = out / "truth.txt"
    estimate = out / "trajectory.txt"
    if truth.exists() and estimate.exists():
        lines.append("ATE      " + describe_error(estimate, truth))
    if estimate.exists():
        poses = sum(1 for line in open(estimate) if line.strip() and not line.startswith("#"))
        lines.append(f"coverage {outcome.coverage(summary, poses):.4f} ({poses} poses)")
    return "\n".join(lines + [f"results  {out}"])


def describe_error(estimate, truth):
    try:
        result = evaluate_files(estimate, truth)
    except UserError as error:
        return f"none: {error}"
    text = f"{result.ate_m.rmse:.4f} m (rmse after sim3 alignment)"
    if result.compared < result.poses:
        text += f", of {result.compared} of {result.poses} poses: the others have no truth"
    return text
