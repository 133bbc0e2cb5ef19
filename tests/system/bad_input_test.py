"""What a user gets wrong is told in a line that names it, and ends with an exit code."""

import os
import shutil
import unittest

import system


class BadInput(system.SystemTest):
    def copy(self, name):
        """The first ten frames of the sequence, to be spoilt."""
        folder = self.folder / name
        folder.mkdir()
        listed = (system.sequence() / "rgb.txt").read_text().splitlines()[:10]
        (folder / "rgb").mkdir()
        for line in listed:
            shutil.copy(system.sequence() / line.split()[1], folder / "rgb")
        (folder / "rgb.txt").write_text("\n".join(listed) + "\n")
        shutil.copy(system.sequence() / "camera.yaml", folder)
        return folder

    def assert_refused(self, folder, *expected, arguments=()):
        out = self.folder / (folder.name + "-out")
        status, output = self.run_to_end(folder, "--out", out, *arguments)
        self.assertEqual(status, 1, output)
        for text in expected:
            self.assertIn(text, output)
        self.assertNotIn("Traceback", output)
        self.assertNotIn("terminate called", output)
        self.assert_nothing_left()

    def test_no_list(self):
        folder = self.copy("no_list")
        (folder / "rgb.txt").unlink()
        self.assert_refused(folder, "player failed", "no_list: holds no sequence", "rgb/")

    def test_empty_list(self):
        folder = self.copy("empty_list")
        (folder / "rgb.txt").write_text("# timestamp filename\n")
        self.assert_refused(folder, "player failed", "rgb.txt")

    def test_no_camera(self):
        folder = self.copy("no_camera")
        (folder / "camera.yaml").unlink()
        self.assert_refused(folder, "player failed", "camera.yaml", "--camera")

    def test_camera_that_is_not_a_number(self):
        folder = self.copy("nan_camera")
        text = (folder / "camera.yaml").read_text()
        (folder / "camera.yaml").write_text(text.replace("fx: 525.0", "fx: .nan"))
        self.assert_refused(folder, "player failed", "camera.yaml", "not a finite number")

    def test_unknown_setting(self):
        folder = self.copy("settings")
        (folder / "settings.yaml").write_text("frontend:\n  brightness: 7\n")
        self.assert_refused(folder, "frontend failed", "brightness",
                            arguments=["--config", folder / "settings.yaml"])

    def test_unknown_settings_section(self):
        folder = self.copy("section")
        (folder / "settings.yaml").write_text("front_end:\n  brightness: 7\n")
        self.assert_refused(folder, "failed", "front_end", "no such section",
                            arguments=["--config", folder / "settings.yaml"])

    def test_empty_folder(self):
        folder = self.folder / "empty"
        folder.mkdir()
        self.assert_refused(folder, "player failed", "empty: holds no sequence")

    def test_mixed_sizes(self):
        folder = self.copy("mixed")
        for image in sorted((folder / "rgb").iterdir())[3:5]:
            image.write_bytes(b"P5\n32 24\n255\n" + bytes(32 * 24))
        self.assert_refused(folder, "player failed", "is 32 x 24 px", "640 x 480", "2 of 10")

    def test_one_bad_image_is_passed_over(self):
        folder = self.copy("one_bad")
        image = sorted((folder / "rgb").iterdir())[4]
        os.truncate(image, 1000)
        status, output = self.run_to_end(folder, "--out", self.folder / "one_bad-out")
        self.assertEqual(status, 0, output)
        log = (self.folder / "one_bad-out" / "logs" / "player.log").read_text()
        self.assertIn(image.name, log)
        self.assertIn("played 9 of 10 images: 1 skipped (is truncated or no image)", output)
        self.assert_nothing_left()


if __name__ == "__main__":
    unittest.main()
