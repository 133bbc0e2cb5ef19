"""`vpslam spy`: lcm-spy on a running graph, with our message types and the preview."""

import glob
import os
import pathlib
import shutil
import subprocess

from vpslam_tools import console, install_build, paths
from vpslam_tools.errors import UserError
from vpslam_tools.processes import die_with_parent

JARS = ["/usr/share/java/lcm.jar", "/usr/share/java/jchart2d.jar"]
ASK_EVERY_S = 3  # for previews; the frontend publishes them for twice as long


def add_parser(commands):
    parser = commands.add_parser(
        "spy", help="look at the messages of a running graph",
        description="Opens lcm-spy with the message types of VP-SLAM. A double click on a channel "
        "shows its fields, on PREVIEW the picture, which the frontend publishes while this runs.")
    parser.add_argument("--url", metavar="URL", help="of the graph; default: that of the only run")
    parser.add_argument("--build-only", action="store_true",
                        help="make the types' jar, print its name, and end")
    parser.set_defaults(function=spy)


def spy(args):
    install_build.prepare()
    url = None if args.build_only else find_window_and_graph(args.url)
    install_build.ensure_packages(missing_for_java())
    jar = build_types()
    if args.build_only:
        print(jar)
        return 0
    asking = subprocess.Popen(
        console.command_line("command", "show", "--every", str(ASK_EVERY_S), "--url", url),
        stdin=subprocess.DEVNULL, preexec_fn=die_with_parent())
    try:
        return subprocess.run(java_command(jar, url), preexec_fn=die_with_parent(),
                              env=dict(os.environ, CLASSPATH=str(jar))).returncode
    finally:
        asking.kill()
        asking.wait()


def find_window_and_graph(url):
    if not os.environ.get("DISPLAY"):
        raise UserError("lcm-spy opens a window and there is no DISPLAY; try it on a desktop, with "
                        "ssh -X, or look at `vpslam status --watch`")
    return console.find_url(url)


def java_command(jar, url):
    # The wrapper that Debian 12 ships passes an option that its Java no longer knows.
    return ["java", "-Djava.net.preferIPv4Stack=true", "-Xmx256m", "-cp",
            ":".join([*JARS, str(jar)]), "lcm.spy.Spy", "-l", url]


def missing_for_java():
    wanted = [] if all(map(os.path.exists, JARS)) else ["liblcm-java", "libjchart2d-java"]
    if not shutil.which("javac"):
        wanted.append("default-jdk-headless")
    if not glob.glob("/usr/lib/jvm/*/lib/libawt_xawt.so"):
        wanted.append("default-jre")  # the headless one has no windows
    return wanted


def build_types():
    """The jar of our types and the preview's viewer; made anew when one of them has changed."""
    sources = sorted(paths.LCM_TYPES.glob("*.lcm"))
    plugin = paths.SPY_PLUGIN
    folder = paths.spy_folder()
    jar = folder / "vpslam-types.jar"
    if jar.exists() and all(jar.stat().st_mtime > path.stat().st_mtime
                            for path in (*sources, plugin)):
        return jar
    java, classes = folder / "java", folder / "classes"
    for path in (java, classes):
        shutil.rmtree(path, ignore_errors=True)
        path.mkdir(parents=True)
    run(["lcm-gen", "-j", "--jpath", str(java), *map(str, sources)])
    files = [str(path) for path in sorted(java.rglob("*.java"))] + [str(plugin)]
    run(["javac", "-nowarn", "-cp", JARS[0], "-d", str(classes), *files])
    unfinished = pathlib.Path(str(jar) + ".new")
    run(["jar", "cf", str(unfinished), "-C", str(classes), "."])
    os.replace(unfinished, jar)
    return jar


def run(command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise UserError(f"{command[0]} failed: {(done.stderr or done.stdout).strip()}")
