"""The folders of the sources build on each other in one direction: no circle of includes."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
PROCESSES = {"player", "vpdetector", "frontend", "backend", "recorder", "console"}
INCLUDE = re.compile(r'^#include "([\w/]+\.h)"', re.MULTILINE)


def folder(path):
    """core/map of core/map/map.h, frontend of frontend/tracker.h."""
    parts = pathlib.PurePath(path).parts
    return "/".join(parts[:2] if parts[0] == "core" else parts[:1])


def includes(root):
    """{folder: {other folder that it includes: "file -> header", ...}, ...} below `root`."""
    found = {}
    for top in sorted({"core"} | PROCESSES):
        for file in sorted((root / top).rglob("*")):
            if file.suffix not in (".h", ".cpp"):
                continue
            name = file.relative_to(root).as_posix()
            own = found.setdefault(folder(name), {})
            for header in INCLUDE.findall(file.read_text()):
                if folder(header) != folder(name) and (root / header).exists():
                    own.setdefault(folder(header), f"{name} -> {header}")
    return found


def circle(graph):
    """The includes along one circle of folders; [] if there is none."""
    def walk(at, trail):
        if at in trail:
            trail = trail[trail.index(at):] + [at]
            return [graph[a][b] for a, b in zip(trail, trail[1:])]
        if at in done:
            return []
        for other in graph.get(at, {}):
            if found := walk(other, trail + [at]):
                return found
        done.add(at)
        return []

    done = set()
    for start in graph:
        if found := walk(start, []):
            return found
    return []


class FoldersTest(unittest.TestCase):
    def test_no_circle(self):
        graph = includes(ROOT)
        self.assertIn("core/features", graph["core/map"])  # headers are found at all
        self.assertEqual(circle(graph), [])

    def test_a_circle_is_found(self):
        graph = {"a": {"b": "a/1.h -> b/2.h"}, "b": {"c": "b/3.h -> c/4.h"},
                 "c": {"b": "c/5.h -> b/6.h"}}
        self.assertEqual(circle(graph), ["b/3.h -> c/4.h", "c/5.h -> b/6.h"])

    def test_processes_know_core_alone(self):
        for name, others in includes(ROOT).items():
            between = [where for other, where in others.items()
                       if not other.startswith("core/")]
            self.assertEqual(between, [], name)


if __name__ == "__main__":
    unittest.main()
