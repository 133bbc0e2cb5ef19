"""ATE, RPE and rotation error once more, by other means than vpslam_tools: association by looking at
every pair, quaternions instead of matrices, Horn's eigenvector instead of Umeyama's SVD.

B. K. P. Horn, "Closed-form solution of absolute orientation using unit quaternions", JOSA A 4(4),
1987. Frobenius distance of two rotations: |R - S|^2 = 8 (1 - (q_R . q_S)^2), so the best constant
rotation is an eigenvector, too.
"""

import math
import pathlib

import numpy as np


def read(path):
    """[(stamp, position, quaternion w x y z)]"""
    poses = []
    for line in pathlib.Path(path).read_text(encoding="utf-8").splitlines():
        words = line.split("#")[0].split()
        if words:
            stamp, x, y, z, qx, qy, qz, qw = map(float, words)
            norm = math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw)
            poses.append((stamp, (x, y, z), (qw / norm, qx / norm, qy / norm, qz / norm)))
    return sorted(poses)


def multiply(a, b):
    return (a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
            a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0])


def conjugate(q):
    return (q[0], -q[1], -q[2], -q[3])


def rotate(q, v):
    return multiply(multiply(q, (0.0, *v)), conjugate(q))[1:]


def angle_deg(q):
    return math.degrees(2 * math.atan2(math.hypot(*q[1:]), abs(q[0])))


def largest_eigenvector(matrix):
    values, vectors = np.linalg.eigh(matrix)
    return tuple(vectors[:, np.argmax(values)])


def associate(estimate, truth, max_difference_s=0.02):
    pairs = []
    for pose in estimate:
        near = min(truth, key=lambda other: abs(other[0] - pose[0]))
        if abs(near[0] - pose[0]) <= max_difference_s:
            pairs.append((pose, near))
    return pairs


def horn(source, target, with_scale=True):
    """scale, quaternion, translation of the similarity (or rigid motion) that maps source to target."""
    n = len(source)
    source_mean = [sum(p[i] for p in source) / n for i in range(3)]
    target_mean = [sum(p[i] for p in target) / n for i in range(3)]
    a = [[p[i] - source_mean[i] for i in range(3)] for p in source]
    b = [[p[i] - target_mean[i] for i in range(3)] for p in target]
    s = [[sum(u[i] * v[j] for u, v in zip(a, b)) for j in range(3)] for i in range(3)]
    q = largest_eigenvector(np.array([
        [s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]],
        [s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]],
        [s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]],
        [s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1]]]))
    turned = [rotate(q, u) for u in a]
    scale = (sum(v[i] * u[i] for u, v in zip(turned, b) for i in range(3))
             / sum(u[i] * u[i] for u in a for i in range(3))) if with_scale else 1.0
    mean = rotate(q, source_mean)
    return scale, q, [target_mean[i] - scale * mean[i] for i in range(3)]


def rmse(errors):
    return math.sqrt(sum(error * error for error in errors) / len(errors))


def evaluate(estimate, truth, with_scale=True):
    """{"ate_m", "scale", "rotation_deg", "rpe_m", "rpe_deg"}: RMSE, and {"drift_deg_per_m"}: as
    evaluation.py defines them."""
    pairs = associate(estimate, truth)
    scale, q, t = horn([pose[1] for pose, _ in pairs], [near[1] for _, near in pairs], with_scale)
    distances = []
    for pose, near in pairs:
        moved = rotate(q, pose[1])
        distances.append(math.dist([scale * moved[i] + t[i] for i in range(3)], near[1]))
    turns = [multiply(near[2], conjugate(pose[2])) for pose, near in pairs]
    constant = largest_eigenvector(sum(np.outer(turn, turn) for turn in turns))
    rotation = [angle_deg(multiply(conjugate(near[2]), multiply(constant, pose[2])))
                for pose, near in pairs]
    shifts, relative = relative_errors(pairs, scale)
    return {"ate_m": rmse(distances), "scale": scale, "rotation_deg": rmse(rotation),
            "rpe_m": rmse(shifts), "rpe_deg": rmse(relative), "drift_deg_per_m": drift(pairs)}


def drift(pairs):
    way = [0.0]
    for (_, a), (_, b) in zip(pairs, pairs[1:]):
        way.append(way[-1] + math.dist(a[1], b[1]))
    rates = []
    for i, (first, first_truth) in enumerate(pairs):
        if way[i] > 0.5 * way[-1]:
            break
        j = next((k for k in range(i, len(way)) if way[k] >= way[i] + 0.5 * way[-1]), len(way) - 1)
        second, second_truth = pairs[j]
        turn = multiply(conjugate(first[2]), second[2])
        true_turn = multiply(conjugate(first_truth[2]), second_truth[2])
        rates.append(angle_deg(multiply(conjugate(true_turn), turn)) / (way[j] - way[i]))
    rates.sort()
    middle = len(rates) // 2
    return rates[middle] if len(rates) % 2 else (rates[middle - 1] + rates[middle]) / 2


def relative_errors(pairs, scale, delta_s=1.0):
    stamps = [pose[0] for pose, _ in pairs]
    gaps = sorted(b - a for a, b in zip(stamps, stamps[1:]))
    middle = len(gaps) // 2
    median = gaps[middle] if len(gaps) % 2 else (gaps[middle - 1] + gaps[middle]) / 2
    shifts, turns = [], []
    for i, (first, first_truth) in enumerate(pairs):
        j = min(range(len(stamps)), key=lambda k: (abs(stamps[k] - (stamps[i] + delta_s)), k))
        if j <= i or abs(stamps[j] - stamps[i] - delta_s) > max(0.02, median / 2):
            continue
        second, second_truth = pairs[j]
        motions = []
        for a, b, factor in ((first, second, scale), (first_truth, second_truth, 1.0)):
            back = conjugate(a[2])
            step = [factor * (b[1][k] - a[1][k]) for k in range(3)]
            motions.append((multiply(back, b[2]), rotate(back, step)))
        shifts.append(math.dist(motions[0][1], motions[1][1]))
        turns.append(angle_deg(multiply(conjugate(motions[1][0]), motions[0][0])))
    return shifts, turns
