"""Installs the Debian packages that are missing, builds, and runs the tests.

What apt, CMake and the compiler say goes to stderr: stdout belongs to the command that was asked
for (`vpslam evaluate --json` is read by other programs).
"""

import fcntl
import os
import re
import shutil
import subprocess
import sys

from vpslam_tools import paths
from vpslam_tools.errors import UserError

APT_INSTALL = ["apt-get", "-o", "DPkg::Lock::Timeout=300", "install", "-y",
               "--no-install-recommends"]
COMPILER_MEMORY_GB = 1.2  # one translation unit of Eigen and Ceres


def add_parsers(commands):
    build = commands.add_parser("build", help="install what is missing and build")
    build.set_defaults(function=lambda args: prepare())
    test = commands.add_parser("test", help="the same, then run every test; arguments go to ctest",
                               add_help=False)
    test.set_defaults(function=run_tests)


def prepare():
    """Before any command that needs the binaries; at once where all is up to date."""
    if paths.has_to_build():
        ensure_packages()
        build(target="programs")
    return 0


def run_tests(args):
    if not paths.IN_SOURCE_TREE:
        raise UserError("there are no tests in an installation; run scripts/test in a source tree")
    ensure_packages()
    build(target="all", tests=True)
    command = ["ctest", "--test-dir", str(paths.BUILD), "--output-on-failure",
               "-j", str(os.cpu_count() or 1)] + args.rest
    return subprocess.run(command).returncode


# --- packages

def listed_packages():
    lines = (line.split("#")[0].strip() for line in paths.PACKAGES.read_text().splitlines())
    return [line for line in lines if line]


def missing_packages(wanted):
    # Unknown names make dpkg-query fail but are simply absent from what it prints.
    listing = subprocess.run(
        ["dpkg-query", "-W", "-f", "${Package} ${db:Status-Status}\\n"] + wanted,
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    installed = {line.split()[0] for line in listing.splitlines() if line.endswith(" installed")}
    return [name for name in wanted if name not in installed]


def ensure_packages(wanted=None):
    """`wanted`: default is what scripts/packages.txt lists."""
    if not shutil.which("dpkg-query"):
        return  # not Debian: CMake will say what it does not find
    wanted = listed_packages() if wanted is None else wanted
    missing = missing_packages(wanted) if wanted else []
    if not missing:
        return
    become_root = []
    if os.geteuid() != 0:
        if not shutil.which("sudo"):
            raise UserError("packages are missing and there is no sudo; as root type: apt-get "
                            "install --no-install-recommends " + " ".join(missing))
        become_root = ["sudo"]
    tell("installing " + " ".join(missing))
    # An update that fails in part (one mirror down) may still do: the installation will tell.
    subprocess.run(become_root + ["apt-get", "update"], stdout=sys.stderr)
    done = subprocess.run(
        become_root + ["env", "DEBIAN_FRONTEND=noninteractive"] + APT_INSTALL + missing,
        stdout=sys.stderr, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise UserError("apt-get could not install the packages (see above)")


# --- building

def build(target, tests=False):
    """Configures where that was never done, and builds `target`. One at a time: neither Ninja nor
    Make guards a build tree against a second run."""
    paths.BUILD.mkdir(exist_ok=True)
    with open(paths.BUILD / ".vpslam-lock", "w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            tell("waiting for another build in " + str(paths.BUILD))
            fcntl.flock(lock, fcntl.LOCK_EX)
        configure(tests)
        command = ["cmake", "--build", str(paths.BUILD), "--target", target,
                   "--parallel", str(parallel_jobs())]
        if run_with_progress(command) != 0:
            raise UserError("the build failed (see above)")


def configure(tests):
    wanted = {"VPSLAM_TESTS": "ON"} if tests else {}
    if "VPSLAM_WERROR" in os.environ:
        wanted["VPSLAM_WERROR"] = os.environ["VPSLAM_WERROR"]
    cache = paths.BUILD / "CMakeCache.txt"
    cached = cache.read_text() if cache.exists() else ""
    generated = any((paths.BUILD / name).exists() for name in ("build.ninja", "Makefile"))
    if generated and all(f"{key}:BOOL={value}\n" in cached for key, value in wanted.items()):
        return  # CMake runs again by itself when its files have changed
    command = ["cmake", "-S", str(paths.ROOT), "-B", str(paths.BUILD)]
    command += [f"-D{key}={value}" for key, value in wanted.items()]
    if not cached:
        command += ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release"]
    if subprocess.run(command, stdout=sys.stderr).returncode != 0:
        raise UserError("CMake could not configure the build (see above)")


def parallel_jobs():
    memory_gb = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9
    return max(1, min(os.cpu_count() or 1, int(memory_gb / COMPILER_MEMORY_GB)))


def run_with_progress(command):
    """Runs a build: steps overwrite each other on a terminal, anything else is shown as it is, and
    a build that has nothing to do says nothing."""
    on_terminal = sys.stderr.isatty()
    width = shutil.get_terminal_size().columns - 1
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                               text=True, errors="replace")
    try:
        pending_line = show_steps(process, on_terminal, width)
    except BaseException:
        process.terminate()  # nobody waits for it any more
        raise
    if pending_line:
        print(file=sys.stderr)
    return process.wait()


def show_steps(process, on_terminal, width):
    """Returns whether the last line is still to be ended."""
    pending_line = False
    for line in process.stdout:
        line = line.rstrip("\n")
        if re.search(r"Re-checking globbed|no work to do|^\[\s*100%\] Built target", line):
            continue
        is_step = re.match(r"\[\s*\d+(/\d+|%)\]", line)
        if is_step and on_terminal:
            print("\r\033[K" + line[:width], end="", file=sys.stderr, flush=True)
        else:
            print(("\n" if pending_line else "") + line, file=sys.stderr, flush=True)
        pending_line = bool(is_step and on_terminal)
    return pending_line


def tell(text):
    print("vpslam: " + text, file=sys.stderr, flush=True)
