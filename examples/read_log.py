#!/usr/bin/python3
"""Reads a log of VP-SLAM messages in Python, with nothing but the classes that lcm-gen makes:

    lcm-gen --python --ppath types lcmtypes/*.lcm
    examples/read_log.py results/RUN/log.lcm types

Prints the final pose of each tracked frame, in the TUM format (camera to world), and what else the
log holds on standard error. A log is written by `vpslam run --record features` or by lcm-logger.
"""

import collections
import importlib
import struct
import sys

SYNC = 0xEDA1DA01
# Channel: message type.
TYPES = {"CAMERA": "camera_t", "IMAGE": "image_t", "FEATURES": "features_t", "LINES": "lines_t",
         "LINES_REQUEST": "lines_request_t", "POSE": "pose_t", "TRUTH": "truth_t",
         "KEYFRAME": "keyframe_t", "MAP": "map_delta_t", "MAP_REQUEST": "map_request_t",
         "ACK": "ack_t", "COMMAND": "command_t", "RUN": "run_t", "STATUS": "status_t",
         "PREVIEW": "preview_t", "OUTCOME": "outcome_t"}


def events(path):
    """Channel and bytes of each event of an LCM log."""
    with open(path, "rb") as log:
        while len(head := log.read(28)) == 28:
            sync, _, _, channel_length, data_length = struct.unpack(">IqqII", head)
            if sync != SYNC:
                sys.exit(f"{path}: is no LCM log, or damaged; `vpslam log` says where")
            channel = log.read(channel_length).decode()
            yield channel, log.read(data_length)


def camera_centre(cam_from_world):
    """x_cam = R x_world + t, so the camera stands at -R^T t, turned by R^T."""
    w, x, y, z = cam_from_world.rotation
    t = cam_from_world.translation
    rotation = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return [-sum(rotation[row][column] * t[row] for row in range(3)) for column in range(3)]


def main(path, types):
    sys.path.insert(0, types)
    vpslam = importlib.import_module("vpslam")
    counts, poses = collections.Counter(), {}
    for channel, data in events(path):
        if channel not in TYPES:
            continue
        message = getattr(vpslam, TYPES[channel]).decode(data)
        counts[channel] += 1
        # A pose that was found later replaces the one that was sent when the frame was new.
        if channel == "POSE" and not message.header.last:
            poses[message.frame_seq] = message
    for channel, count in sorted(counts.items()):
        print(f"{channel:14}{count}", file=sys.stderr)
    for _, pose in sorted(poses.items()):
        if pose.state == vpslam.pose_t.TRACKING:
            w, x, y, z = pose.cam_from_world.rotation
            numbers = [*camera_centre(pose.cam_from_world), -x, -y, -z, w]
            print(f"{pose.stamp_us / 1e6:.6f} " + " ".join(f"{n:.6f}" for n in numbers))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__.strip())
    main(sys.argv[1], sys.argv[2])
