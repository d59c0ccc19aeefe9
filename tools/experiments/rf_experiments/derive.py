# SPDX-License-Identifier: BSD-3-Clause
"""Inputs made from a sequence: priors that fail, and sequences in which something happens to the sensor.
Only values and files in, files out; random numbers come from the given seed alone."""
import math
import random
import struct
import zlib

from . import poses

JUMP_METRES = 0.10
JUMP_EVERY_S = (1.0, 3.0)  # pause between two jumps, drawn uniformly
EVENT_FRAMES = {"lens covered": 15, "black colour": 10, "depth gone": 15, "teleport": 1}
EVENTS = tuple(EVENT_FRAMES)
TELEPORT_METRES = 1.0


def frozen(trajectory):
    """Standing still from the middle on: a stalled source that goes on reporting."""
    middle = len(trajectory) // 2
    return [(time, trajectory[min(i, middle)][1]) for i, (time, _) in enumerate(trajectory)]


def random_direction(source):
    z = source.uniform(-1, 1)
    angle = source.uniform(-math.pi, math.pi)
    across = math.sqrt(1 - z * z)
    return across * math.cos(angle), across * math.sin(angle), z


def jumping(trajectory, seed):
    """The poses with lasting jumps of 10 cm in random directions every one to three seconds."""
    source = random.Random(f"jumping {seed}")
    offset = (0.0, 0.0, 0.0)
    due = float(trajectory[0][0]) + source.uniform(*JUMP_EVERY_S)
    result = []
    for time, (t, q) in trajectory:
        if float(time) >= due:
            offset = tuple(o + JUMP_METRES * d for o, d in zip(offset, random_direction(source)))
            due += source.uniform(*JUMP_EVERY_S)
        result.append((time, (tuple(a + b for a, b in zip(t, offset)), q)))
    return result


def png(width, height, bits, channels):
    """Bytes of a PNG whose pixels are all zero: 8-bit colour (channels 3) or 8/16-bit grey (1)."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, bits, 2 if channels == 3 else 0, 0, 0, 0)
    rows = bytes(height * (1 + width * channels * bits // 8))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def image_list(path):
    """[(time as written, file)] of rgb.txt or depth.txt."""
    lines = [line.split() for line in path.read_text().splitlines()]
    return [(w[0], w[1]) for w in lines if len(w) >= 2 and not w[0].startswith("#")]


def write_list(path, entries):
    path.write_text("\n".join(f"{time} {file}" for time, file in entries) + "\n")


def link_all(sequence, folder, without):
    """Links to all that the sequence holds, but for names that are to be written anew."""
    folder.mkdir(parents=True)
    for item in sorted(sequence.iterdir()):
        if item.name not in without:
            (folder / item.name).symlink_to(item.resolve())


def image_size(sequence):
    lines = [line.split(":") for line in (sequence / "camera.yaml").read_text().splitlines() if ":" in line]
    values = {key.strip(): value.strip() for key, value in lines}
    return int(values["width"]), int(values["height"])


def event_frame(frames):
    """Index of the first frame that an event touches: after the middle, where tracking is settled."""
    return frames * 3 // 5


def spoil(sequence, folder, event):
    """A sequence in which colour, depth or both are lost for some frames."""
    lists = [name for name, events in (("rgb.txt", ("lens covered", "black colour")),
                                       ("depth.txt", ("lens covered", "depth gone"))) if event in events]
    link_all(sequence, folder, without=lists)
    width, height = image_size(sequence)
    (folder / "empty").mkdir()
    (folder / "empty/rgb.png").write_bytes(png(width, height, 8, 3))
    (folder / "empty/depth.png").write_bytes(png(width, height, 16, 1))
    for name in lists:
        entries = image_list(sequence / name)
        first = event_frame(len(entries))
        for i in range(first, min(first + EVENT_FRAMES[event], len(entries))):
            entries[i] = (entries[i][0], f"empty/{name.removesuffix('.txt')}.png")
        write_list(folder / name, entries)


def splice_prior(trajectory, before, after):
    """A source that measures motion and does not see the jump: increments up to frame `before` and from
    frame `after` on, joined by the increment that would have followed `before`."""
    kept = trajectory[:before + 1]
    bridge = poses.product(poses.inverse(trajectory[before][1]), trajectory[before + 1][1])
    pose = poses.product(kept[-1][1], bridge)
    kept.append((trajectory[before + 1][0], pose))
    for k in range(after + 1, len(trajectory)):
        step = poses.product(poses.inverse(trajectory[k - 1][1]), trajectory[k][1])
        pose = poses.product(pose, step)
        kept.append((trajectory[before + 1 + k - after][0], pose))
    return kept


def splice(items, before, after):
    """[(time, value)] without the items between, at the times of the first ones."""
    values = [v for _, v in items[:before + 1]] + [v for _, v in items[after:]]
    return [(time, v) for (time, _), v in zip(items, values)]


def landing(truth, before):
    """First frame whose camera is a metre away from that of frame `before`."""
    for k in range(before + 1, len(truth)):
        if poses.distance(truth[before][1], truth[k][1]) >= TELEPORT_METRES:
            return k
    raise ValueError("the camera does not get 1 m away after the event: take the whole scene")


def teleport(sequence, folder):
    """The camera is set down a metre further on; priors that measure motion do not notice."""
    truth = poses.read(sequence / "groundtruth.txt")
    before = event_frame(len(truth)) // 2 - 1
    after = landing(truth, before)
    rewritten = ["rgb.txt", "depth.txt", "mask", "object_motion.txt"]
    rewritten += [item.name for item in sequence.glob("*groundtruth.txt")]
    rewritten += [item.name for item in sequence.glob("*odometry.txt")]
    link_all(sequence, folder, without=rewritten)
    for name in rewritten:
        path = sequence / name
        if name.endswith("groundtruth.txt"):
            poses.write(folder / name, splice(poses.read(path), before, after))
        elif name.endswith("odometry.txt"):
            poses.write(folder / name, splice_prior(poses.read(path), before, after))
        elif name in ("rgb.txt", "depth.txt"):
            write_list(folder / name, splice(image_list(path), before, after))
    (folder / "mask").mkdir()
    times = [(time, time) for time, _ in image_list(sequence / "depth.txt")]
    for new, old in splice(times, before, after):
        (folder / "mask" / f"{new}.png").symlink_to((sequence / "mask" / f"{old}.png").resolve())


def first_touched(event, frames):
    """Index of the first frame that shows the event in a derived sequence; `frames`: of the original."""
    return event_frame(frames) // 2 if event == "teleport" else event_frame(frames)


def sequence_with(event, sequence, folder):
    """Writes the folder with an event of EVENTS in it."""
    if event == "teleport":
        teleport(sequence, folder)
    else:
        spoil(sequence, folder, event)


def cut(sequence, folder, start, frames):
    """Some of a recording's frames; what else it holds is linked as it is."""
    link_all(sequence, folder, without=["rgb.txt", "depth.txt"])
    depth = image_list(sequence / "depth.txt")[start:][:frames or None]
    write_list(folder / "depth.txt", depth)
    begin, end = float(depth[0][0]) - 0.05, float(depth[-1][0]) + 0.05
    colour = [e for e in image_list(sequence / "rgb.txt") if begin <= float(e[0]) <= end]
    write_list(folder / "rgb.txt", colour)


PRIORS = {"frozen": lambda trajectory, seed: frozen(trajectory), "jumping": jumping}


def prior(kind, given, file, seed):
    """Writes the given trajectory file as one that fails in that way."""
    poses.write(file, PRIORS[kind](poses.read(given), seed))
