# SPDX-License-Identifier: BSD-3-Clause
"""How soon the mask is right after the object has started to move, at five sizes."""
from .. import measures, stats, tables
from ..plan import size_scene
from ..report import lines, over_time
from ..runs import Case, Run

TITLE = "Onset: frames until the mask is right"

SIZES = (14, 43, 65, 72, 80)
START, FRAMES = 5, 70  # the objects of the size scenes rest until frame 30 and are 1 cm away at 37


def cases(plan):
    chosen = [size_scene(50)] if plan.quick else plan.choose([size_scene(s) for s in SIZES], quick=())
    return [Case.of(Run(plan.sequence(scene, seed, START, FRAMES)), size=int(scene[4:]) / 100, seed=seed)
            for scene in chosen for seed in plan.seeds]


def measure(finished, row):
    return measures.onset(finished.each_frame())


def curve(finished):
    """[(seconds, IoU)] from 1 cm of displacement on: its zero is the onset frame."""
    frames = finished.each_frame()
    first = measures.onset(frames)["onset_frame"]
    if first is None:
        return []
    begin = frames[first]["timestamp"]
    return [(f["timestamp"] - begin, f["iou"]) for f in frames if (f["object_displacement_m"] or 0) > 0]


def report(rows, out):
    out.text("Counted from 1 cm of displacement of the object; right: IoU at least 0.8 and both classes' accuracy at "
             "least 0.9. Found: right within 3 frames. Held: share of right masks from then on while it moves. "
             "To reach: found in 95 % of the seeds at every size.")
    out.table(rows, ("size",), [("share at onset", "onset_share", 2), ("found", tables.per_cent("onset_found")),
                                ("delay, frames", "onset_delay", 0), ("IoU after 3 frames", "onset_iou", 3),
                                ("held", "onset_held", 2)])
    out.text(f"Over all sizes found in {tables.per_cent('onset_found')(rows)} of {len(rows)} runs.")
    late = [{**r, "runs": "delay"} for r in rows]
    out.plot("delay", lines, late, "size", "runs", "onset_delay", "share of the view", "frames", limit=3)
    panels = {}
    for row in rows:
        panels.setdefault(f"size {row['size']:.2f}", {})[f"seed {row['seed']}"] = curve(row["finished"])
    out.plot("iou", over_time, panels, "IoU")


def found_share(rows):
    """{size: share of the seeds}."""
    return {size: stats.share(r["onset_found"] for r in g) for (size,), g in tables.grouped(rows, ("size",))}
