"""What a run does with lines and vanishing points: presets, and switches over them, as settings.

A preset is a set of switches, a single switch goes over it, and the user's own --set over both.
What neither preset nor switch names stays as --config or the programs have it.
"""

from vpslam_tools.errors import UserError

DEFAULT = "default"
OFF, ON = "off", "on"
VP_METHODS = ["three_line", "two_line_grid", "two_line_grid_raw"]

# Switch: (its values, the settings that it sets, what it is about).
SWITCHES = {
    "lines": ([ON, OFF], ["frontend.lines.enabled", "backend.lines.enabled"],
              "map lines and track by them"),
    "vp": (VP_METHODS, ["vpdetector.vps.method"], "how vanishing points are found"),
    "manhattan": ([ON, OFF], ["backend.manhattan.enabled"],
                  "hold bundle adjustment to the Manhattan frame of the map"),
    "vp-init": ([ON, OFF], ["frontend.initializer.vps"],
                "let vanishing points have a say in how a map starts"),
    "rotation": ([OFF, "paper", "fused"], ["frontend.rotation.mode"],
                 "what tracking makes of vanishing points: nothing, the rotation itself (the "
                 "paper's section III-B), or a factor of the pose, for which --manhattan has to be "
                 "on"),
    "translation": ([OFF, "paper", "weighted"], ["frontend.translation"],
                    "translation once more, with known rotation (the paper's section III-C)"),
}
# Without any of these there is nothing for a detector to do.
NEED_DETECTORS = ["lines", "manhattan", "vp-init", "rotation"]

PRESETS = {
    DEFAULT: {},
    "points": {"lines": OFF, "manhattan": OFF, "vp-init": OFF, "rotation": OFF, "translation": OFF},
    "points-lines": {"lines": ON, "manhattan": OFF, "vp-init": OFF, "rotation": OFF,
                     "translation": OFF},
    "paper": {"lines": ON, "vp": "two_line_grid", "manhattan": OFF, "vp-init": OFF,
              "rotation": "paper", "translation": "paper"},
}
# Settings of a preset that no switch stands for.
FURTHER_SETTINGS = {"paper": ["vpdetector.lines.detector.kind=lsd"]}


def add_arguments(parser):
    parser.add_argument("--preset", choices=list(PRESETS), default=DEFAULT,
                        help="default: what does best; points: point features only; points-lines: "
                        "no vanishing points; paper: what the paper describes")
    for name, (values, _, what) in SWITCHES.items():
        parser.add_argument(f"--{name}", choices=values, help=f"{what}; default: the preset's")


def given(args):
    """The single switches that were given, {name: value}."""
    return {name: value for name in SWITCHES
            if (value := getattr(args, _attribute(name), None)) is not None}


def check(args):
    """Refuses what would silently have no effect."""
    if getattr(args, "rotation", None) == "fused" and _chosen(args).get("manhattan") == OFF:
        raise UserError("--rotation fused measures against the Manhattan frame of the map; add "
                        "--manhattan on")


def _chosen(args):
    return {**PRESETS[args.preset], **given(args)}


def settings(args):
    """["section.key=value"], to be applied before the user's own."""
    words = list(FURTHER_SETTINGS.get(args.preset, []))
    for name, value in _chosen(args).items():
        values, keys, _ = SWITCHES[name]
        text = {ON: "true", OFF: "false"}[value] if values == [ON, OFF] else value
        words += [f"{key}={text}" for key in keys]
    return words


def detectors(args):
    """How many detectors preset and switches ask for, where --detectors does not say."""
    chosen = _chosen(args)
    return int(any(chosen.get(name) != OFF for name in NEED_DETECTORS))


def words(args):
    """The command line that says the same."""
    return [word for name, value in {"preset": args.preset, **given(args)}.items()
            for word in (f"--{name}", value)]


def options():
    """Names of the options as argparse has them."""
    return ["preset"] + [_attribute(name) for name in SWITCHES]


def _attribute(name):
    return name.replace("-", "_")
