# SPDX-License-Identifier: BSD-3-Clause
"""The recordings that ship with the project."""
from .. import stats
from ..plan import QUICK_FRAMES
from ..report import CAMERA_COLUMNS, bars
from ..runs import NONE, PAPER_CAMERA_DRIFT, PAPER_OBJECT_DRIFT, Case, Run, Sequence

TITLE = "Real recordings"

ROTATING = "tum_fr1_rpy"  # and longer cuts of it, tum_fr1_rpy_...
WALKING = "tum_fr3_walking_halfsphere"
FIRST_JUDGED_FRAME = 4  # from the fifth frame on: the mask of a body needs a reference some frames back
QUICK_RECORDED = 24


def rotating(plan, name):
    """With the drifting truth as prior, one run a drift seed, and without any."""
    drift = PAPER_CAMERA_DRIFT + PAPER_OBJECT_DRIFT
    for seed in plan.seeds:
        run = Run(Sequence(name, seed, recorded=True), object_prior=NONE, drift=drift)
        yield Case.of(run, recording=name, camera_prior="drift 6 cm/s", seed=seed)
    run = Run(Sequence(name, recorded=True), camera_prior=NONE, object_prior=NONE)
    yield Case.of(run, recording=name, camera_prior="none", seed=1)


def walking(plan, name):
    frames = min(QUICK_FRAMES, QUICK_RECORDED) if plan.quick else 0
    run = Run(Sequence(name, frames=frames, recorded=True), camera_prior=NONE, object_prior=NONE)
    yield Case.of(run, recording=name, camera_prior="none", seed=1)


def cases(plan):
    wanted = []
    for name in plan.recordings:
        if name.startswith(ROTATING) and not plan.quick:
            wanted += rotating(plan, name)
        if name.startswith(WALKING):
            wanted += walking(plan, name)
    return wanted


def longest(rows, prefix, key):
    """The rows of the recording with that prefix that has the most frames, of those that have the number."""
    own = [r for r in rows if r["recording"].startswith(prefix) and r.get(key) is not None]
    most = max((r["frames"] for r in own), default=0)
    return [r for r in own if r["frames"] == most]


def measure(finished, row):
    judged = [f for f in finished.each_frame()[FIRST_JUDGED_FRAME:] if f["iou"] is not None]
    masks = stats.pooled(judged)
    return {"iou_judged": masks["iou"], "iou_worst_frame": min((f["iou"] for f in judged), default=None),
            "judged_frames": masks["frames"]}


def report(rows, out):
    out.text("fr1_rpy: the truth with simulated drift as prior (one run a drift seed), and no prior. "
             "walking_halfsphere: against the hand-drawn masks, from the fifth frame on, over the pixels of all of "
             "them; and how much of the static map lies on what they call dynamic.")
    out.table(rows, ("recording", "camera_prior"),
              [("frames", "frames", 0), ("prior ATE SE3, cm", "prior_ate_se3_cm", 2)] + CAMERA_COLUMNS
              + [("IoU", "iou_judged", 3), ("IoU, worst frame", "iou_worst_frame", 3),
                 ("frames with masks", "judged_frames", 0),
                 ("share of the map on people", "static_on_moving_share", 3)])
    shown = [r for r in rows if r["camera_ate_se3_cm"] is not None]
    if shown:
        out.plot("ate", bars, shown, "camera_prior", "recording", "camera_ate_se3_cm", "ATE, aligned in SE(3), cm")
    masked = [r for r in rows if r["iou_judged"] is not None]
    if masked:
        out.plot("iou", bars, masked, "camera_prior", "recording", "iou_judged", "IoU")
