# SPDX-License-Identifier: BSD-3-Clause
"""Rigid transforms and trajectory files in TUM layout (`time tx ty tz qx qy qz qw`), without numpy.
A pose is (t, q): translation in metres and unit quaternion x, y, z, w; T_AB maps B to A."""
import math


def quaternion_product(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


def rotate(q, p):
    x, y, z, _ = quaternion_product(quaternion_product(q, (*p, 0.0)), (-q[0], -q[1], -q[2], q[3]))
    return x, y, z


def product(a, b):
    """T_AC = T_AB * T_BC."""
    moved = rotate(a[1], b[0])
    q = quaternion_product(a[1], b[1])
    norm = math.sqrt(sum(c * c for c in q))
    return tuple(u + v for u, v in zip(a[0], moved)), tuple(c / norm for c in q)


def inverse(a):
    q = (-a[1][0], -a[1][1], -a[1][2], a[1][3])
    return tuple(-c for c in rotate(q, a[0])), q


def distance(a, b):
    """Between the origins of two poses, metres."""
    return math.dist(a[0], b[0])


def path_length(trajectory):
    """Metres that the origin travels."""
    return sum(distance(a[1], b[1]) for a, b in zip(trajectory, trajectory[1:]))


def read(path):
    """[(time as written, pose)], comments left out."""
    trajectory = []
    for line in path.read_text().splitlines():
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        values = [float(w) for w in words[1:8]]
        trajectory.append((words[0], (tuple(values[:3]), tuple(values[3:7]))))
    return trajectory


def write(path, trajectory):
    lines = ["# timestamp tx ty tz qx qy qz qw"]
    lines += [f"{time} " + " ".join(f"{c:.9f}" for c in (*t, *q)) for time, (t, q) in trajectory]
    path.write_text("\n".join(lines) + "\n")
