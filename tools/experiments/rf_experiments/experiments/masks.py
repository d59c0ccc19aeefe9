# SPDX-License-Identifier: BSD-3-Clause
"""IoU of the dynamic class and accuracy per class, over time and over all moving frames, slow ones apart."""
from .. import measures, stats, tables
from ..plan import CAMERA_SCENES, SIZES, size_scene
from ..report import MASK_COLUMNS, over_time
from ..runs import Case, Run

TITLE = "Masks: IoU and accuracy per class over time"

SLOW = (0.01, 0.05)  # m/s
SERIES = ("iou", "static_accuracy", "dynamic_accuracy")


def cases(plan):
    scenes = plan.choose(CAMERA_SCENES + tuple(size_scene(s) for s in SIZES), quick=("sideway",))
    return [Case.of(Run(plan.sequence(scene, seed)), scene=scene, seed=seed)
            for scene in scenes for seed in plan.seeds]


def measure(finished, row):
    slow = stats.pooled(measures.between_speeds(finished.each_frame(), *SLOW))
    return {f"{key}_slow": value for key, value in slow.items()}


def series(finished):
    """{name: [(seconds from the first frame, value)]} while the object moves."""
    frames = finished.each_frame()
    begin = frames[0]["timestamp"]
    moves = [(f["object_speed_m_per_s"] or 0) > SLOW[0] for f in frames]
    return {name: [(f["timestamp"] - begin, f[name] if m else None) for f, m in zip(frames, moves)]
            for name in SERIES}


def over_time_rows(rows):
    """One row a frame of every run."""
    for row in rows:
        for frame in row["finished"].each_frame():
            yield {"scene": row["scene"], "seed": row["seed"], **frame}


def report(rows, out):
    out.text("Over the pixels of all frames in which the object moves, and of those in which it moves with 1 to "
             "5 cm/s. The figure shows the first seed of each camera sequence; every frame stands in "
             "masks-over-time.csv.")
    out.table(rows, ("scene",), MASK_COLUMNS + [
        ("IoU slow", "iou_slow", 3), ("acc. static slow", "static_accuracy_slow", 3),
        ("acc. dynamic slow", "dynamic_accuracy_slow", 3), ("slow frames", "frames_slow", 0)])
    tables.write_csv(out.folder / "masks-over-time.csv", list(over_time_rows(rows)))
    shown = [r for r in rows if r["scene"] in CAMERA_SCENES] or rows
    firsts = {scene: group[0] for (scene,), group in tables.grouped(shown, ("scene",))}
    panels = {f"{scene}, seed {row['seed']}": series(row["finished"]) for scene, row in firsts.items()}
    out.plot("over-time", over_time, panels, "share")
