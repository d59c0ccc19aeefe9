# SPDX-License-Identifier: BSD-3-Clause
"""How much of the view the object may fill."""
from .. import stats, tables
from ..plan import BASELINES, SIZES, size_scene
from ..report import CAMERA_COLUMNS, MASK_COLUMNS, OBJECT_COLUMNS, lines
from ..runs import Case, Run

TITLE = "Object size: ATE and IoU against the share of the view"

TRACKED_CM = 5.0  # the paper's bound for a tracked camera


def cases(plan):
    chosen = plan.choose([size_scene(s) for s in SIZES], quick=(size_scene(50),))
    modes = plan.modes(() if plan.quick else BASELINES)
    return [Case.of(Run(plan.sequence(scene, seed), mode=mode), size=int(scene[4:]) / 100, method=mode, seed=seed)
            for scene in chosen for mode, seeds in modes for seed in seeds]


def measure(finished, row):
    return {}


def largest_tracked(rows, method="rigidfusion"):
    """The largest size up to which every size's median ATE is below 5 cm; None when the smallest is not."""
    largest = None
    own = [r for r in rows if r["method"] == method]
    for (size,), group in sorted(tables.grouped(own, ("size",))):
        ate = stats.median(r["camera_ate_first_cm"] for r in group)
        if ate is None or ate >= TRACKED_CM:
            break
        largest = size
    return largest


def report(rows, out):
    out.text("A broad stack passes close to the camera; size is its mean share of the valid pixels. "
             "Paper's drift. The scene lasts 6 s.")
    for method in dict.fromkeys(r["method"] for r in rows):
        out.text(f"Largest size still tracked by {method} (median ATE below 5 cm there and at every smaller size): "
                 f"{tables.text_of(largest_tracked(rows, method)) or 'none'}")
    out.table(rows, ("method", "size"), CAMERA_COLUMNS + OBJECT_COLUMNS + MASK_COLUMNS)
    out.plot("ate", lines, rows, "size", "method", "camera_ate_first_cm", "share of the view", "ATE, cm", log=True,
             limit=TRACKED_CM)
    out.plot("iou", lines, rows, "size", "method", "iou_moving", "share of the view", "IoU", limit=0.9)
