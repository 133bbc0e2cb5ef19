"""What moves with the camera: a mask keeps features and lines away from it, in the frontend, in the
detectors and in a replay; and without a mask it does not spoil the start of a map."""

import importlib
import pathlib
import subprocess
import sys
import unittest

import numpy as np

import system

sys.path.insert(0, str(system.SOURCE / "examples"))

import read_log  # noqa: E402

FRAMES = 60
SHARE = 0.2  # of the image, at its lower edge


def read_pgm(path):
    data = path.read_bytes()
    _, width, height, _ = data.split(maxsplit=4)[:4]
    width, height = int(width), int(height)
    return np.frombuffer(data[-width * height:], np.uint8).reshape(height, width)


def write_pgm(path, image):
    path.write_bytes(b"P5\n%d %d\n255\n" % image.shape[::-1] + image.tobytes())


class Mask(system.SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sequence = cls.folder / "with_bonnet"
        (cls.sequence / "rgb").mkdir(parents=True)
        rng = np.random.default_rng(1)
        bonnet = None
        names = []
        for line in (system.sequence() / "rgb.txt").read_text().splitlines()[:FRAMES]:
            stamp, name = line.split()
            image = read_pgm(system.sequence() / name).copy()
            cls.height, cls.width = image.shape
            cls.first_hidden = round((1 - SHARE) * cls.height)
            if bonnet is None:  # blocks of random brightness, with corners and lines
                blocks = rng.integers(30, 220, (cls.height // 16 + 1, cls.width // 16 + 1))
                bonnet = np.kron(blocks, np.ones((16, 16)))[:cls.height, :cls.width]
            noisy = bonnet + rng.normal(0, 1.5, image.shape)
            image[cls.first_hidden:] = np.clip(noisy, 0, 255).astype(np.uint8)[cls.first_hidden:]
            names.append(f"{stamp} {name}\n")
            write_pgm(cls.sequence / name, image)
        (cls.sequence / "rgb.txt").write_text("".join(names))
        for name in ("camera.yaml", "groundtruth.txt"):
            (cls.sequence / name).write_text((system.sequence() / name).read_text())
        mask = np.full((cls.height, cls.width), 255, np.uint8)
        mask[cls.first_hidden:] = 0
        write_pgm(cls.folder / "mask.pgm", mask)
        write_pgm(cls.folder / "small.pgm", mask[::2, ::2])

    def test_nothing_is_seen_where_it_is_black(self):
        out = self.folder / "masked"
        status, output = self.run_to_end(self.sequence, "--mask", self.folder / "mask.pgm",
                                         "--record", "all", "--out", out)
        self.assertEqual(status, 0, output)
        hidden, seen = self.count_below(out / "log.lcm")
        self.assertEqual(hidden, {"FEATURES": 0, "LINES": 0})
        self.assertGreater(seen["FEATURES"], 300 * FRAMES)
        self.assertGreater(seen["LINES"], 10 * FRAMES)
        again = self.folder / "again"
        status, output = self.finish(self.start(out, "--out", again, command="replay"))
        self.assertEqual(status, 0, output)
        self.assert_same_results(out, again)

    def count_below(self, log):
        """Of key points and line segments: how many lie in the bonnet, and how many elsewhere."""
        types = self.folder / "types"
        subprocess.run(["lcm-gen", "--python", "--ppath", types,
                        *(system.SOURCE / "lcmtypes").glob("*.lcm")], check=True)
        sys.path.insert(0, str(types))
        vpslam = importlib.import_module("vpslam")
        hidden, seen = {"FEATURES": 0, "LINES": 0}, {"FEATURES": 0, "LINES": 0}
        for channel, data in read_log.events(log):
            if channel not in hidden:
                continue
            message = getattr(vpslam, read_log.TYPES[channel]).decode(data)
            if channel == "FEATURES":
                # A corner of a higher octave is known to its pixel there.
                rows = [point.y_px - 1.5 * 1.2 ** point.octave for point in message.keypoints]
            else:
                rows = [max(line.start_px[1], line.end_px[1]) - 2 for line in message.lines]
            below = sum(row > self.first_hidden for row in rows)
            hidden[channel] += below
            seen[channel] += len(rows) - below
        return hidden, seen

    def test_a_calibration_can_name_it(self):
        named = self.folder / "named.yaml"
        named.write_text((self.sequence / "camera.yaml").read_text() + "mask: mask.pgm\n")
        outs = [self.folder / "by_option", self.folder / "by_calibration"]
        for out, arguments in zip(outs, (["--mask", self.folder / "mask.pgm"],
                                         ["--camera", named])):
            status, output = self.run_to_end(self.sequence, *arguments, "--frames", 40,
                                             "--out", out)
            self.assertEqual(status, 0, output)
        self.assert_same_results(*outs)

    def test_one_of_another_size_is_refused(self):
        status, output = self.run_to_end(self.sequence, "--mask", self.folder / "small.pgm",
                                         "--out", self.folder / "refused")
        self.assertEqual(status, 1)
        self.assertRegex(output, r"small\.pgm: the mask has \d+ x \d+ px, the camera \d+ x \d+")
        status, output = self.run_to_end(self.sequence, "--mask", "none.png")
        self.assertEqual(status, 1)
        self.assertIn("none.png: no such file; check --mask", output)

    def test_without_a_mask_the_map_starts_right(self):
        out = self.folder / "unmasked"
        status, output = self.run_to_end(self.sequence, "--out", out)
        self.assertEqual(status, 0, output)
        result = self.evaluate(out, system.sequence())
        self.assertLess(result["ate_m"]["rmse"], 0.02, output)


if __name__ == "__main__":
    unittest.main()
