"""A folder that is full, or may not be written: what fits is there, and one line says the rest."""

import subprocess
import unittest

import system

# Runs a command with a small file system of its own on "$1", then copies what is there to "$2".
INSIDE = """
disk=$1 copy=$2 options=$3; shift 3
mount -t tmpfs -o "$options" none "$disk" || exit 77
"$@"; status=$?
cp -r "$disk" "$copy"
exit $status
"""


def has_mount_namespaces():
    return subprocess.run(["unshare", "--map-root-user", "--net", "--mount", "sh", "-c",
                           "mount -t tmpfs none /mnt"], stderr=subprocess.DEVNULL).returncode == 0


PAGE_BYTES = 4096


def pages(size):
    """What a file takes of a tmpfs."""
    return -(-size // PAGE_BYTES)


class FullDisk(system.SystemTest):
    def run_on_disk(self, name, options, *arguments):
        if not has_mount_namespaces():
            self.skipTest("mount namespaces are not allowed here")
        disk, copy = self.folder / name, self.folder / (name + "_copy")
        disk.mkdir()
        done = subprocess.run(
            ["unshare", "--map-root-user", "--net", "--mount", "sh", "-c", INSIDE, "sh", disk, copy,
             options, system.VPSLAM, "run", system.sequence(), *arguments, "--out", disk / "out"],
            cwd=self.folder, capture_output=True, text=True, timeout=300)
        return done.returncode, done.stdout + done.stderr, copy / "out"

    def test_the_trajectory_is_written_where_the_map_does_not_fit(self):
        status, output, _ = self.run_on_disk("large", "size=20m", "--frames", "40")
        self.assertEqual(status, 0, output)
        sizes = {path.name: path.stat().st_size
                 for path in (self.folder / "large_copy" / "out").iterdir() if path.is_file()}
        logs = sum(pages(path.stat().st_size)
                   for path in (self.folder / "large_copy" / "out" / "logs").iterdir())
        # Room for all but the map, and for half of that: logs may be a little longer this time.
        others = sum(pages(size) for name, size in sizes.items() if name != "map.ply")
        room = PAGE_BYTES * (others + logs + pages(sizes["map.ply"]) // 2)
        status, output, out = self.run_on_disk("small", f"size={room}", "--frames", "40")
        self.assertEqual(status, 1, output)
        self.assertIn("recorder failed with exit code 1", output)
        self.assertIn("cannot write map.ply (No space left on device); all other results are "
                      "there; free space", output)
        self.assertNotIn("Traceback", output)
        self.assertEqual((out / "trajectory.txt").read_bytes(),
                         (self.folder / "large_copy" / "out" / "trajectory.txt").read_bytes())
        self.assertTrue((out / "summary.json").exists())
        self.assertFalse((out / "map.ply").exists())
        self.assertEqual(list(out.glob(".*")), [], "unfinished files are left")

    def test_a_folder_that_cannot_be_written(self):
        status, output, _ = self.run_on_disk("read_only", "ro", "--frames", "5")
        self.assertEqual(status, 1)
        self.assertIn("out: cannot be made (Read-only file system); name another folder with --out",
                      output)
        self.assertNotIn("Traceback", output)
        self.assertLessEqual(output.count("\n"), 2, output)  # multicast route; the error

    def test_other_commands_say_it_in_a_line(self):
        (self.folder / "file").write_text("")
        under = self.folder / "file" / "under"
        for arguments in (["evaluate", system.sequence() / "groundtruth.txt",
                           system.sequence() / "groundtruth.txt", "--plot", under],
                          ["bench", "--suite", "sim", "--out", under],
                          ["fetch-datasets", "tum", "freiburg1_xyz", "--out", under]):
            with self.subTest(arguments[0]):
                done = subprocess.run([system.VPSLAM, *map(str, arguments)], capture_output=True,
                                      text=True, cwd=self.folder, timeout=120)
                self.assertNotEqual(done.returncode, 0)
                self.assertNotIn("Traceback", done.stdout + done.stderr)
                self.assertIn(str(self.folder / "file"), done.stderr)


if __name__ == "__main__":
    unittest.main()
