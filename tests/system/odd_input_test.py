"""What is played with a loss, or otherwise than it is written, says so on the console and in
summary.json."""

import json
import shutil
import struct
import unittest

import system

FRAMES = 40


class OddInput(system.SystemTest):
    def copy(self, name, stamps_s=lambda stamps_s: stamps_s):
        """The first frames of the sequence, with the time stamps that `stamps_s` makes of theirs."""
        folder = self.folder / name
        (folder / "rgb").mkdir(parents=True)
        rows = [line.split() for line in
                (system.sequence() / "rgb.txt").read_text().splitlines()[:FRAMES]]
        for _, image in rows:
            (folder / image).symlink_to(system.sequence() / image)
        stamps = stamps_s([float(stamp) for stamp, _ in rows])
        (folder / "rgb.txt").write_text("".join(
            f"{stamp:.6f} {image}\n" for stamp, (_, image) in zip(stamps, rows)))
        for file in ("camera.yaml", "groundtruth.txt"):
            shutil.copy(system.sequence() / file, folder)
        return folder

    def play(self, sequence, *arguments, command="run"):
        out = self.folder / f"{sequence.name}-out"
        status, output = self.finish(self.start(sequence, "--out", out, *arguments,
                                                command=command))
        self.assertEqual(status, 0, output)
        self.assert_nothing_left()
        return output, json.loads((out / "summary.json").read_text())

    def test_an_image_that_is_set_aside(self):
        def one_in_the_future(stamps_s):
            stamps_s[20] += 1e9
            return stamps_s
        output, summary = self.play(self.copy("future", one_in_the_future))
        self.assertIn(f"played {FRAMES - 1} of {FRAMES} images: 1 skipped (time stamp out of place)",
                      output)
        self.assertEqual(summary["sequence"]["expected"], FRAMES)
        self.assertEqual(summary["sequence"]["played"], FRAMES - 1)
        self.assertEqual(summary["sequence"]["skipped"], {"time stamp out of place": 1})
        without_pose = sum(summary["no_pose"].values())
        self.assertEqual(without_pose, FRAMES - 1 - summary["frames"]["tracked"])
        # Of the sequence, not of what was played.
        coverage = summary["frames"]["tracked"] / FRAMES
        self.assertIn(f"coverage {coverage:.4f} ({summary['frames']['tracked']} poses)", output)

    def test_a_shuffled_list(self):
        output, summary = self.play(self.copy("shuffled"))
        self.assertIn(f"played {FRAMES} of {FRAMES} images\n", output)
        folder = self.folder / "shuffled"
        lines = (folder / "rgb.txt").read_text().splitlines(keepends=True)
        (folder / "rgb.txt").write_text("".join(lines[1::2] + lines[::2]))
        again, resorted = self.play(folder)
        self.assertRegex(again, r"note .*rgb\.txt: is not in order of time, and was sorted")
        self.assertEqual(resorted["frames"]["tracked"], summary["frames"]["tracked"])

    def test_a_gap_of_an_hour_in_real_time(self):
        def later(stamps_s):
            return stamps_s[:20] + [stamp + 3600 for stamp in stamps_s[20:]]
        output, summary = self.play(self.copy("gap", later), "--pace", "realtime")
        self.assertRegex(output, r"player: a gap of 3600\.0\d* s in the time stamps, before image 20, "
                         r"is played as one of 5 s")
        self.assertIn(f"played {FRAMES} of {FRAMES} images", output)
        self.assertLess(summary["wall_s"], 60)

    def test_a_log_with_holes(self):
        sequence = self.copy("recorded")
        self.play(sequence, "--record", "all", "--detectors", "0")
        log = self.folder / "holes.lcm"
        content = (self.folder / "recorded-out" / "log.lcm").read_bytes()
        kept, at, images = [], 0, 0
        while at < len(content):
            _, _, _, channel, data = struct.unpack(">IqqII", content[at:at + 28])
            end = at + 28 + channel + data
            if content[at + 28:at + 28 + channel] == b"IMAGE":
                images += 1
            # The last message of the channel ends it.
            if not (content[at + 28:at + 28 + channel] == b"IMAGE" and images % 3 == 2
                    and images <= FRAMES):
                kept.append(content[at:end])
            at = end
        lost = FRAMES // 3
        log.write_bytes(b"".join(kept[:30]) + b"foreign bytes" + b"".join(kept[30:]))
        output, summary = self.play(log, command="replay")
        self.assertRegex(output, rf"played {FRAMES - lost} of {FRAMES} images: {lost} skipped "
                         r"\(missing in the log\)")
        self.assertRegex(output, r"note .*13 bytes in 1 places are damaged")
        self.assertEqual(summary["sequence"]["expected"], FRAMES)


if __name__ == "__main__":
    unittest.main()
