#!/usr/bin/python3
"""Renders a short sequence in TUM's layout: a walk along a textured room with a few pillars.

    make_sequence.py FOLDER

Everything is deterministic. Surfaces are axis-aligned boxes: the room seen from inside, the pillars
from outside; each ray is cut with their slabs, and each face looks into a part of its own of one
texture of random rectangles.
"""

import argparse
import pathlib
import sys

import numpy as np

WIDTH, HEIGHT, FOCAL_PX, FPS = 640, 480, 525.0, 30
ROOM = np.array([[-3, -1.5, -3], [3, 1.5, 3]], np.float32)  # metres; x right, y down, z forward
PILLARS = np.array([[[-1.6, -1.5, 1.2], [-1.1, 1.5, 1.7]],
                    [[0.2, 0.2, 0.6], [0.8, 1.5, 1.2]],
                    [[1.3, -1.5, 1.8], [1.7, 1.5, 2.2]],
                    [[-0.6, 0.5, 1.9], [-0.1, 1.5, 2.4]]], np.float32)
TEXEL_M, TEXTURE_SIZE = 0.007, 1024
NOISE = 1.5  # grey levels
FRAMES = 120


def make_texture(generator):
    texture = np.full((TEXTURE_SIZE, TEXTURE_SIZE), 128.0, np.float32)
    for size in (300, 120, 60, 30):
        for _ in range(int(0.8 * (TEXTURE_SIZE / size) ** 2)):
            width, height = generator.integers(size // 4, size, 2)
            x, y = generator.integers(0, TEXTURE_SIZE, 2)
            texture[y:y + height, x:x + width] = generator.uniform(30, 225)
    texture += 12 * generator.standard_normal(texture.shape, np.float32)  # no two corners are alike
    for axis in (0, 1):  # edges as soft as a pixel sees them
        texture = (np.roll(texture, 1, axis) + 2 * texture + np.roll(texture, -1, axis)) / 4
    return texture


def sample(texture, u, v):
    """Bilinear, with wrap-around; u, v in texels."""
    left, top = np.floor(u), np.floor(v)
    right_share, bottom_share = u - left, v - top
    left, top = left.astype(np.int32), top.astype(np.int32)
    left, right = left % TEXTURE_SIZE, (left + 1) % TEXTURE_SIZE
    top, bottom = top % TEXTURE_SIZE, (top + 1) % TEXTURE_SIZE
    upper = texture[top, left] * (1 - right_share) + texture[top, right] * right_share
    lower = texture[bottom, left] * (1 - right_share) + texture[bottom, right] * right_share
    return upper * (1 - bottom_share) + lower * bottom_share


def camera_pose(frame):
    """Position and rotation world_from_cam: sways from side to side, nods and turns a little."""
    t = frame / FPS
    position = np.array([-1.0 + 0.45 * t, 0.15 * np.sin(1.9 * t), -2.0 + 0.25 * np.sin(1.3 * t)])
    yaw, pitch = 0.10 * np.sin(1.1 * t), 0.05 * np.sin(1.7 * t)
    turn_y = np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])
    turn_x = np.array([[1, 0, 0], [0, np.cos(pitch), -np.sin(pitch)],
                       [0, np.sin(pitch), np.cos(pitch)]])
    quaternion = np.array([np.sin(pitch / 2) * np.cos(yaw / 2), np.cos(pitch / 2) * np.sin(yaw / 2),
                           -np.sin(pitch / 2) * np.sin(yaw / 2),
                           np.cos(pitch / 2) * np.cos(yaw / 2)])  # x y z w of turn_y * turn_x
    return position, turn_y @ turn_x, quaternion


def pixel_rays():
    x, y = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    return np.stack([(x - (WIDTH - 1) / 2) / FOCAL_PX, (y - (HEIGHT - 1) / 2) / FOCAL_PX,
                     np.ones_like(x)]).reshape(3, -1).astype(np.float32)


def render(frame, rays_in_cam, texture, generator):
    position, rotation, _ = (part.astype(np.float32) for part in camera_pose(frame))
    rays = rotation @ rays_in_cam
    rays[np.abs(rays) < 1e-9] = 1e-9

    def cuts(box):
        """Distances at which each ray enters and leaves the box, and the axes of those faces."""
        first, second = ((corner - position)[:, None] / rays for corner in box)
        near, far = np.minimum(first, second), np.maximum(first, second)
        return near.max(axis=0), near.argmax(axis=0), far.min(axis=0), far.argmin(axis=0)

    _, _, distance, axis = cuts(ROOM)
    surface = np.zeros(len(distance), np.int32)
    for number, box in enumerate(PILLARS, start=1):
        enter, enter_axis, leave, _ = cuts(box)
        hit = (enter < leave) & (enter > 0) & (enter < distance)
        distance = np.where(hit, enter, distance)
        axis = np.where(hit, enter_axis, axis)
        surface[hit] = number
    x, y, z = position[:, None] + distance * rays
    along_u, along_v = np.where(axis == 0, z, x), np.where(axis == 1, z, y)
    across = np.choose(axis, rays) > 0
    face = 6 * surface + 2 * axis + across
    grey = sample(texture, along_u / np.float32(TEXEL_M) + 331 * face.astype(np.float32),
                  along_v / np.float32(TEXEL_M) + 197 * face.astype(np.float32))
    grey *= np.array([0.85, 0.7, 1.0], np.float32)[axis]  # light from the front
    grey += NOISE * generator.standard_normal(len(grey), np.float32)
    return np.clip(np.rint(grey), 0, 255).astype(np.uint8).reshape(HEIGHT, WIDTH)


def make_sequence(folder):
    folder = pathlib.Path(folder)
    (folder / "rgb").mkdir(parents=True, exist_ok=True)
    generator = np.random.default_rng(20240101)
    texture, rays = make_texture(generator), pixel_rays()
    listing, truth = [], []
    for frame in range(FRAMES):
        stamp = f"{1000 + frame / FPS:.6f}"
        image = render(frame, rays, texture, generator)
        name = f"rgb/{stamp}.pgm"
        (folder / name).write_bytes(b"P5\n%d %d\n255\n" % (WIDTH, HEIGHT) + image.tobytes())
        position, _, quaternion = camera_pose(frame)
        listing.append(f"{stamp} {name}")
        truth.append(" ".join([stamp] + [f"{value:.9f}" for value in (*position, *quaternion)]))
    (folder / "groundtruth.txt").write_text("\n".join(truth) + "\n")
    (folder / "camera.yaml").write_text(
        f"width: {WIDTH}\nheight: {HEIGHT}\nfps: {FPS}\nfx: {FOCAL_PX}\nfy: {FOCAL_PX}\n"
        f"cx: {(WIDTH - 1) / 2}\ncy: {(HEIGHT - 1) / 2}\n")
    (folder / "rgb.txt").write_text("\n".join(listing) + "\n")  # last: it marks a whole sequence


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder")
    arguments = parser.parse_args()
    listing = pathlib.Path(arguments.folder, "rgb.txt")
    if listing.exists() and listing.stat().st_mtime > pathlib.Path(__file__).stat().st_mtime:
        sys.exit(0)  # rendered before, by this very file
    make_sequence(arguments.folder)
