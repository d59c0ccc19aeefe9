# SPDX-License-Identifier: BSD-3-Clause
"""An object that leaves the view, or is hidden, and comes back."""
from .. import measures, tables
from ..report import CAMERA_COLUMNS, MASK_COLUMNS, OBJECT_COLUMNS, over_time
from ..runs import Case, Run

TITLE = "Coming back: after leaving the view, after being hidden"

SCENES = ("leave", "behind")


def cases(plan):
    scenes = [s for s in plan.choose(SCENES, quick=()) if s in plan.known_scenes]
    return [Case.of(Run(plan.sequence(scene, seed)), scene=scene, seed=seed)
            for scene in scenes for seed in plan.seeds]


def measure(finished, row):
    return measures.comeback(finished.each_frame())


def curves(finished):
    frames = finished.each_frame()
    begin = frames[0]["timestamp"]
    return {"IoU": [(f["timestamp"] - begin, f["iou"] if (f["dynamic_share"] or 0) > 0 else None) for f in frames],
            "share of the view": [(f["timestamp"] - begin, f["dynamic_share"]) for f in frames]}


def report(rows, out):
    out.text("Gone: the longest time without a pixel of the object after it has moved (below 0.5 % of the view). Back: "
             "2 % of the view. Found again: a right mask (IoU 0.8, both accuracies 0.9) within half a second of that, "
             "and the object's pose half a second after it, against the truth.")
    out.table(rows, ("scene",),
              [("gone, frames", "gone_frames", 0), ("found again", tables.per_cent("found_again")),
               ("delay, frames", "comeback_delay", 0), ("object off then, cm", "comeback_object_error_cm", 1),
               ("object has a pose", "object_coverage", 2)]
              + CAMERA_COLUMNS + OBJECT_COLUMNS + MASK_COLUMNS + [("map within 2 cm", "static_model_share_2cm", 3)])
    firsts = {scene: group[0] for (scene,), group in tables.grouped(rows, ("scene",))}
    out.plot("over-time", over_time, {f"{s}, seed {r['seed']}": curves(r["finished"]) for s, r in firsts.items()},
             "share")
