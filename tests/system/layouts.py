"""Writes the first frames of the tests' sequence in the layouts of other data sets.

Each function fills a folder and returns the arguments of `vpslam run` for it. The images are the
same in all of them, so results must be as good as those from the sequence itself.
"""

import shutil
import struct
import zlib

import numpy as np

FRAMES = 60
WIDTH, HEIGHT, FOCAL_PX = 640, 480, 525.0
CX, CY = (WIDTH - 1) / 2, (HEIGHT - 1) / 2


class Frames:
    """paths: of the images (PGM); stamps_s: floats; poses: n x 8, TUM's rows."""

    def __init__(self, sequence, count=FRAMES):
        rows = [line.split() for line in (sequence / "rgb.txt").read_text().splitlines()[:count]]
        self.paths = [sequence / name for _, name in rows]
        self.stamps_s = [float(stamp) for stamp, _ in rows]
        self.poses = np.loadtxt(sequence / "groundtruth.txt")[:count]
        self.camera = sequence / "camera.yaml"

    def pixels(self, index):
        return self.paths[index].read_bytes()[-WIDTH * HEIGHT:]

    def write_png(self, index, path):
        rows = self.pixels(index)
        raw = b"".join(b"\0" + rows[v * WIDTH:(v + 1) * WIDTH] for v in range(HEIGHT))

        def chunk(kind, data):
            body = kind + data
            return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))
        header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 0, 0, 0, 0)  # 8 bits, grey
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
                         + chunk(b"IDAT", zlib.compress(raw, 1)) + chunk(b"IEND", b""))


def rotation(quaternion):
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def euroc(frames, folder):
    """The body is turned and shifted against the camera."""
    cam0 = folder / "mav0" / "cam0"
    stamps_ns = [round(stamp * 1e9) for stamp in frames.stamps_s]
    for index, stamp_ns in enumerate(stamps_ns):
        frames.write_png(index, cam0 / "data" / f"{stamp_ns}.png")
    (cam0 / "data.csv").write_text("#timestamp [ns],filename\r\n" + "".join(
        f"{stamp_ns},{stamp_ns}.png\r\n" for stamp_ns in stamps_ns))
    # body_from_cam: the camera's axes x, y, z are the body's -y, -z, x.
    body_from_cam = np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]], float)
    camera_in_body = np.array([0.3, -0.2, 0.1])
    matrix = np.vstack([np.column_stack([body_from_cam, camera_in_body]), [0, 0, 0, 1]])
    (cam0 / "sensor.yaml").write_text(
        "# General sensor definitions.\nsensor_type: camera\ncomment: VI-Sensor cam0 (MT9M034)\n\n"
        "# Sensor extrinsics wrt. the body-frame.\nT_BS:\n  cols: 4\n  rows: 4\n  data: ["
        + ",\n         ".join(", ".join(map(str, row)) for row in matrix.tolist()) + "]\n\n"
        f"# Camera specific definitions.\nrate_hz: 30\nresolution: [{WIDTH}, {HEIGHT}]\n"
        f"camera_model: pinhole\nintrinsics: [{FOCAL_PX}, {FOCAL_PX}, {CX}, {CY}] #fu, fv, cu, cv\n"
        "distortion_model: radial-tangential\n"
        "distortion_coefficients: [0.0, 0.0, 0.0, 0.0]\n")
    # quaternion x y z w of cam_from_body, to be applied from the right
    cam_from_body = np.array([0.5, -0.5, 0.5, 0.5])
    assert np.allclose(rotation(cam_from_body), body_from_cam.T)
    lines = ["#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], "
             "q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], "
             "b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1], "
             "b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]"]
    for stamp_ns, pose in zip(stamps_ns, frames.poses):
        x, y, z, w = product(pose[4:], cam_from_body)
        body = pose[1:4] - rotation(np.array([x, y, z, w])) @ camera_in_body
        lines.append(",".join(map(str, [stamp_ns, *body, w, x, y, z] + 9 * [0.0])))
    truth = folder / "mav0" / "state_groundtruth_estimate0"
    truth.mkdir()
    (truth / "data.csv").write_text("\n".join(lines) + "\n")
    return [folder]


def product(p, q):
    """Of quaternions x y z w."""
    vector = p[3] * q[:3] + q[3] * p[:3] + np.cross(p[:3], q[:3])
    return np.append(vector, p[3] * q[3] - p[:3] @ q[:3])


def kitti(frames, folder):
    sequence = folder / "sequences" / "00"
    for index in range(len(frames.paths)):
        frames.write_png(index, sequence / "image_0" / f"{index:06}.png")
    (sequence / "times.txt").write_text(
        "".join(f"{stamp - frames.stamps_s[0]:.6e}\n" for stamp in frames.stamps_s))
    (sequence / "calib.txt").write_text("".join(
        f"P{camera}: " + " ".join(f"{value:.12e}" for value in (
            FOCAL_PX, 0, CX, shift, 0, FOCAL_PX, CY, 0, 0, 0, 1, 0)) + "\n"
        for camera, shift in enumerate((0, -386.0, 45.0, -337.0))))
    (folder / "poses").mkdir()
    (folder / "poses" / "00.txt").write_text("".join(
        " ".join(f"{value:.6e}" for value in
                 np.column_stack([rotation(pose[4:]), pose[1:4]]).ravel()) + "\n"
        for pose in frames.poses))
    return [sequence]


def icl(frames, folder):
    """Numbers instead of times, and y up in the truth."""
    truth, associations = [], []
    for index, pose in enumerate(frames.poses):
        frames.write_png(index, folder / "rgb" / f"{index}.png")
        associations.append(f"{index} depth/{index}.png {index} rgb/{index}.png")
        tx, ty, tz, qx, qy, qz, qw = pose[1:]
        if index > 0:  # the first image has no pose
            truth.append(" ".join(map(str, [index, tx, -ty, tz, -qx, qy, -qz, qw])))
    (folder / "associations.txt").write_text("\n".join(associations) + "\n")
    (folder / "livingRoom0.gt.freiburg").write_text("\n".join(truth) + "\n")
    return [folder, "--camera", frames.camera]


def images(frames, folder):
    for index in range(len(frames.paths)):
        frames.write_png(index, folder / f"shot{index}.png")
    return [folder, "--camera", frames.camera, "--fps", "30"]


def video(frames, folder):
    """YUV4MPEG2, which FFmpeg reads and which holds plain pixels."""
    folder.mkdir()
    clip = folder / "clip.y4m"
    with open(clip, "wb") as file:
        file.write(b"YUV4MPEG2 W%d H%d F30:1 Ip A1:1 Cmono\n" % (WIDTH, HEIGHT))
        for index in range(len(frames.paths)):
            file.write(b"FRAME\n" + frames.pixels(index))
    return [clip, "--camera", frames.camera]


def camera(frames, folder):
    """A video that stands in for a camera, which is gone at its end."""
    shutil.rmtree(folder, ignore_errors=True)
    return video(frames, folder) + ["--source", "camera", "--fps", "10"]
