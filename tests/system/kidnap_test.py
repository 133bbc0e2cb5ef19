"""A camera that is covered, carried away or put back is found again, within a second."""

import json
import subprocess
import sys
import unittest

import system

sys.path.insert(0, str(system.SOURCE / "scripts"))

from vpslam_tools import kidnap, trajectory  # noqa: E402

AT = 80              # frames; what follows is 1.3 s long
MAX_FRAMES = 30      # one second
MAX_ATE_M = 0.03


class Kidnapped(system.SystemTest):
    def check(self, how, frames, alien=None):
        to = self.folder / how
        done = subprocess.run(
            [system.SOURCE / "scripts" / "kidnap", how, system.sequence(), to, "--at", str(AT),
             "--frames", str(frames)] + (["--alien", alien] if alien else []),
            capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        made = kidnap.kidnap(how, kidnap.read_tum(system.sequence()), AT, frames,
                             kidnap.read_tum(alien) if alien else None)
        out = self.folder / f"{how}-out"
        status, output = self.run_to_end(to, "--out", out)
        self.assertEqual(status, 0, output)
        stamps_s = trajectory.read_trajectory(out / "trajectory.txt").stamps_s
        lost = kidnap.frames_to_recover(made, stamps_s, made.seen_from)
        self.assertIsNotNone(lost, "never found again")
        self.assertLessEqual(lost, MAX_FRAMES)
        self.assertLess(self.evaluate(out, to)["ate_m"]["rmse"], MAX_ATE_M)
        self.assert_nothing_left()
        return json.loads((out / "summary.json").read_text())

    def test_a_covered_lens(self):
        self.check("black", 20)

    def test_frames_that_are_missing(self):
        self.check("cut", 15)

    def test_a_jump_back(self):
        summary = self.check("back", 60)
        self.assertEqual(summary["maps"], 1)

    def test_another_place_and_back(self):
        # The same room upside down: nothing in it looks as it did.
        import matplotlib.image
        alien = self.folder / "alien"
        (alien / "rgb").mkdir(parents=True)
        entries = kidnap.read_tum(system.sequence())[:20]
        for i, entry in enumerate(entries):
            pixels = matplotlib.image.imread(entry.image)[::-1]
            matplotlib.image.imsave(alien / "rgb" / f"{i}.png", pixels, cmap="gray", vmin=0, vmax=1)
        (alien / "rgb.txt").write_text(
            "".join(f"{entry.stamp_s} rgb/{i}.png\n" for i, entry in enumerate(entries)))
        (alien / "groundtruth.txt").write_text("0 0 0 0 0 0 0 1\n")
        self.check("elsewhere", 20, alien)


if __name__ == "__main__":
    unittest.main()
