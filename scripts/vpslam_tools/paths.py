"""Where things are: in a source tree or in an installation (`cmake --install`)."""

import os
import pathlib

# <source>/scripts/vpslam_tools, or <prefix>/share/vpslam/scripts/vpslam_tools.
TOOLS = pathlib.Path(__file__).resolve().parent
ROOT = TOOLS.parent.parent
IN_SOURCE_TREE = (ROOT / "CMakeLists.txt").exists()

PACKAGES = ROOT / "scripts" / "packages.txt"
BUILD = ROOT / "build"
CONFIG = ROOT / "config"
LCM_TYPES = ROOT / "lcmtypes"
SPY_PLUGIN = ROOT / "scripts" / "spy" / "PreviewPlugin.java"


def binaries():
    """Folder of the processes. The environment variable VPSLAM_BIN_DIR
    names another one, which is then used as it is: nothing is installed or built."""
    given = os.environ.get("VPSLAM_BIN_DIR")
    if given:
        return pathlib.Path(given).resolve()
    return BUILD / "bin" if IN_SOURCE_TREE else ROOT.parent.parent / "bin"


def spy_folder():
    """Where the Java classes of the message types are built."""
    if IN_SOURCE_TREE:
        return BUILD / "spy"
    cache = os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache"
    return pathlib.Path(cache) / "vpslam" / "spy"


def has_to_build():
    return IN_SOURCE_TREE and not os.environ.get("VPSLAM_BIN_DIR")
