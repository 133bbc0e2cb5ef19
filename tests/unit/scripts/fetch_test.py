"""fetch-datasets against a web server on loopback that knows ranges, cuts connections, and changes
its files."""

import hashlib
import http.server
import io
import pathlib
import subprocess
import sys
import tarfile
import tempfile
import threading
import unittest
import zipfile
from unittest import mock

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(SOURCE / "scripts"))
from vpslam_tools import fetch_command  # noqa: E402
from vpslam_tools.benchmark import catalogue, discovery  # noqa: E402
from vpslam_tools.datasets import Archive, Part, download, euroc, icl, kitti, tum, unpack  # noqa: E402
from vpslam_tools.errors import UserError  # noqa: E402


class Server(http.server.ThreadingHTTPServer):
    """files: {path: bytes}; cut: {path: [bytes after which a connection ends, ...]}"""

    def __init__(self):
        super().__init__(("127.0.0.1", 0), Handler)
        self.files, self.cut, self.requests, self.ranges = {}, {}, [], True

    @property
    def url(self):
        return f"http://127.0.0.1:{self.server_port}"


class Handler(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        server = self.server
        server.requests.append((self.path, self.headers.get("Range")))
        content = server.files.get(self.path)
        if content is None:
            return self.send_error(404)
        tag = '"' + hashlib.md5(content).hexdigest() + '"'
        begin = 0
        asked = self.headers.get("Range")
        if server.ranges and asked and self.headers.get("If-Range") == tag:
            begin = int(asked.removeprefix("bytes=").rstrip("-"))
            if begin >= len(content):
                self.send_response(416)
                self.send_header("Content-Range", f"bytes */{len(content)}")
                self.send_header("Content-Length", "0")
                self.end_headers()
                return None
        self.send_response(206 if begin else 200)
        self.send_header("ETag", tag)
        self.send_header("Content-Length", str(len(content) - begin))
        self.end_headers()
        cuts = server.cut.get(self.path)
        end = begin + cuts.pop(0) if cuts else len(content)
        self.wfile.write(content[begin:end])
        self.close_connection = True

    def log_message(self, *_):
        pass


def tar_of(files):
    file = io.BytesIO()
    with tarfile.open(fileobj=file, mode="w:gz") as archive:
        for name, content in files.items():
            info = tarfile.TarInfo(name)
            info.size = len(content)
            archive.addfile(info, io.BytesIO(content))
    return file.getvalue()


def zip_of(files):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return file.getvalue()


def tum_archive(folder):
    return tar_of({f"{folder}/rgb/1.png": b"image", f"{folder}/depth/1.png": b"depth",
                   f"{folder}/rgb.txt": b"1.0 rgb/1.png\n", f"{folder}/groundtruth.txt": b"#\n"})


class FetchTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="vpslam-fetch-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.server = Server()
        thread = threading.Thread(target=self.server.serve_forever, daemon=True)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(self.server.server_close)
        self.addCleanup(self.server.shutdown)
        for name in ("WAIT_S",):
            patch = mock.patch.object(download, name, 0.0)
            patch.start()
            self.addCleanup(patch.stop)

    def serve(self, archive_or_url, content):
        url = getattr(archive_or_url, "url", archive_or_url)
        path = fetch_command.mirrored(url, self.server.url).removeprefix(self.server.url)
        self.server.files[path] = content
        return path

    def fetch(self, *arguments):
        done = subprocess.run([SOURCE / "scripts" / "fetch-datasets", *arguments, "--out",
                               self.folder, "--mirror", self.server.url], text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        return done.returncode, done.stdout

    def fetch_here(self, dataset, *names):
        args = mock.Mock(dataset=dataset, names=names, out=self.folder, keep=False,
                         mirror=self.server.url)
        with mock.patch.object(fetch_command, "tell"):
            return fetch_command.run(args)


class Datasets(FetchTest):
    def serve_tum(self, folder):
        camera = folder[len("rgbd_dataset_freiburg")]
        return self.serve(tum.URL.format(camera=camera, folder=folder), tum_archive(folder))

    def test_tum(self):
        self.serve_tum("rgbd_dataset_freiburg1_desk")
        status, output = self.fetch("tum", "fr1/desk")
        self.assertEqual(status, 0, output)
        files = sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob("*")
                       if path.is_file())
        base = "tum/rgbd_dataset_freiburg1_desk"
        self.assertEqual(files, [f"{base}/groundtruth.txt", f"{base}/rgb.txt", f"{base}/rgb/1.png"])
        status, output = self.fetch("tum", "freiburg1_desk")
        self.assertEqual((status, len(self.server.requests)), (0, 1), output)
        self.assertIn("is there already", output)

    def test_paper_is_what_the_suite_expects(self):
        for sequence in catalogue.TUM:
            self.serve_tum(sequence.folder)
        status, output = self.fetch("tum", "paper")
        self.assertEqual(status, 0, output)
        self.assertIn("long_office_household_validation", output)
        self.assertIn("no truth is published", output)
        found, missing = discovery.discover(catalogue.TUM, self.folder / "tum")
        self.assertEqual((len(found), missing), (10, []))

    def test_one_that_is_missing_does_not_stop_the_others(self):
        self.serve_tum("rgbd_dataset_freiburg2_desk")
        status, output = self.fetch("tum", "fr2/nothing", "fr2/desk")
        self.assertEqual(status, 1)
        self.assertIn("404", output)
        self.assertIn("1 of 2 are missing: rgbd_dataset_freiburg2_nothing", output)
        self.assertTrue((self.folder / "tum" / "rgbd_dataset_freiburg2_desk").is_dir())
        self.assertNotIn("Traceback", output)

    def serve_euroc(self, damaged=False):
        inner = {name: zip_of({"mav0/cam0/data.csv": b"#\n1,1.png\n", "mav0/cam0/data/1.png": b"i",
                               "mav0/cam1/data/1.png": b"right", "mav0/cam0/sensor.yaml": b"s",
                               "mav0/imu0/data.csv": b"imu", "__MACOSX/mav0/cam0/._data.csv": b"x",
                               "mav0/state_groundtruth_estimate0/data.csv": b"t"})
                 for name in ("MH_01_easy", "MH_02_easy")}
        content = zip_of({f"machine_hall/{name}/{name}.zip": each for name, each in inner.items()})
        self.serve(euroc.ARCHIVES["MH"], content)
        md5 = hashlib.md5(content + b"x" * damaged).hexdigest()
        archive = Archive(euroc.ARCHIVES["MH"].url, "", md5, shared=True)
        patch = mock.patch.dict(euroc.ARCHIVES, {"MH": archive})
        patch.start()
        self.addCleanup(patch.stop)

    def test_euroc(self):
        self.serve_euroc()
        self.assertEqual(self.fetch_here("euroc", "MH_01_easy", "MH_02"), 0)
        self.assertEqual(len(self.server.requests), 1)
        found, _ = discovery.discover(catalogue.EUROC, self.folder / "euroc")
        self.assertEqual([each.sequence.name for each in found], ["MH_01_easy", "MH_02_easy"])
        self.assertFalse((self.folder / "euroc" / "MH_01_easy" / "mav0" / "cam1").exists())
        self.assertEqual(len(list((self.folder / "archives").iterdir())), 1)  # kept for others

    def test_a_wrong_checksum_is_refused(self):
        self.serve_euroc(damaged=True)
        with self.assertRaisesRegex(UserError, "published checksum"):
            self.fetch_here("euroc", "MH_01_easy")
        self.assertEqual(list((self.folder / "archives").iterdir()), [])
        self.assertFalse((self.folder / "euroc" / "MH_01_easy").exists())

    def test_icl(self):
        for folder, prefix in (("living_room_traj2_frei_png", ""), ("traj0_frei_png", "./some/")):
            self.serve(icl.URL.format(folder=folder),
                       tar_of({f"{prefix}rgb/0.png": b"i", f"{prefix}depth/0.png": b"d",
                               f"{prefix}x.gt.freiburg": b"1", f"{prefix}associations.txt": b"a"}))
        status, output = self.fetch("icl", "lr/kt2", "of/kt0")
        self.assertEqual(status, 0, output)
        found, _ = discovery.discover(catalogue.ICL, self.folder / "icl")
        self.assertEqual([each.sequence.name for each in found], ["lr/kt2", "of/kt0"])

    def test_kitti(self):
        base = "dataset/sequences/"
        self.serve(kitti.CALIBRATIONS, zip_of({f"{base}{n}/{f}.txt": b"0\n" for n in ("07", "11")
                                               for f in ("calib", "times")}))
        self.serve(kitti.IMAGES, zip_of({f"{base}{n}/image_{i}/000000.png": b"i"
                                         for n in ("07", "11") for i in (0, 1)}))
        self.serve(kitti.POSES, zip_of({"dataset/poses/07.txt": b"p"}))
        status, output = self.fetch("kitti", "07", "11")
        self.assertEqual(status, 0, output)
        self.assertEqual(len(self.server.requests), 3)
        found, _ = discovery.discover(catalogue.KITTI, self.folder / "kitti")
        self.assertEqual([each.sequence.name for each in found], ["07"])
        self.assertTrue((self.folder / "kitti" / "poses" / "07.txt").is_file())
        self.assertFalse((self.folder / "kitti" / "sequences" / "07" / "image_1").exists())

    def test_unknown_names(self):
        for dataset, name in (("tum", "desk"), ("euroc", "MH_09"), ("icl", "kt0"), ("kitti", "22")):
            status, output = self.fetch(dataset, name)
            self.assertEqual(status, 1)
            self.assertIn(f"{name}: is no sequence", output)


class Download(FetchTest):
    def setUp(self):
        super().setUp()
        self.content = bytes(range(256)) * 4000
        self.server.files["/a.bin"] = self.content
        self.path = self.folder / "a.bin"

    def download(self, md5=None):
        download.download(self.server.url + "/a.bin", self.path, md5, lambda text: None)

    def check(self):
        self.assertEqual(self.path.read_bytes(), self.content)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["a.bin"])

    def test_goes_on_after_cuts(self):
        self.server.cut["/a.bin"] = [1000, 2000, 3000]
        self.download(hashlib.md5(self.content).hexdigest())
        self.check()
        self.assertEqual([each for _, each in self.server.requests],
                         [None, "bytes=1000-", "bytes=3000-", "bytes=6000-"])

    def test_goes_on_in_another_process(self):
        self.server.cut["/a.bin"] = [5000] + [0] * 20
        with mock.patch.object(download, "ATTEMPTS", 2), self.assertRaisesRegex(UserError, "goes on"):
            self.download()
        self.assertEqual((self.folder / "a.bin.part").stat().st_size, 5000)
        self.server.cut.clear()
        self.download()
        self.check()
        self.assertEqual(self.server.requests[-1][1], "bytes=5000-")

    def test_does_not_join_two_versions(self):
        self.server.cut["/a.bin"] = [5000] + [0] * 20
        with mock.patch.object(download, "ATTEMPTS", 2), self.assertRaises(UserError):
            self.download()
        self.server.cut.clear()
        self.content = self.server.files["/a.bin"] = self.content[::-1]
        self.download()
        self.check()

    def test_a_server_without_ranges(self):
        self.server.ranges = False
        self.server.cut["/a.bin"] = [5000]
        self.download()
        self.check()

    def test_all_was_there(self):
        self.download()
        self.path.rename(self.folder / "a.bin.part")
        tag = '"' + hashlib.md5(self.content).hexdigest() + '"'
        (self.folder / "a.bin.part.json").write_text('"' + tag.replace('"', '\\"') + '"')
        self.download()
        self.check()

    def test_no_server(self):
        self.server.shutdown()
        self.server.server_close()
        with mock.patch.object(download, "ATTEMPTS", 2), self.assertRaises(UserError):
            self.download()


class Unpack(FetchTest):
    def test_nothing_lands_outside(self):
        archive = self.folder / "a.tar"
        archive.write_bytes(tar_of({"x/../../evil": b"", "x/rgb/../../../evil": b"",
                                    f"{self.folder}/evil": b"", "x/rgb/good": b"g"}))
        count = unpack.unpack(archive, Part(Archive("", ""), r"(?P<path>.*)"), self.folder / "to")
        self.assertEqual(count, 1)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["a.tar", "to"])

    def test_damaged(self):
        archive = self.folder / "a.tgz"
        for content in (b"no archive", tum_archive("x")[:150], zip_of({"a": b"b" * 99})[:60]):
            archive.write_bytes(content)
            with self.assertRaisesRegex(UserError, "remove it"):
                unpack.unpack(archive, Part(Archive("", ""), r"(?P<path>.*)"), self.folder / "to")


if __name__ == "__main__":
    unittest.main()
