# SPDX-License-Identifier: BSD-3-Clause
"""The recordings that ship with the project."""
from .. import stats
from ..plan import QUICK_FRAMES
from ..report import CAMERA_COLUMNS, bars
from ..runs import GIVEN, NONE, PAPER_CAMERA_DRIFT, PAPER_OBJECT_DRIFT, Case, Run, Sequence

TITLE = "Real recordings"

ROTATING = "tum_fr1_rpy"
WALKING = "tum_fr3_walking_halfsphere"
FIRST_JUDGED_FRAME = 4  # from the fifth frame on: the mask of a body needs a reference some frames back
QUICK_RECORDED = 24


def cases(plan):
    frames = min(QUICK_FRAMES, QUICK_RECORDED) if plan.quick else 0
    drift = PAPER_CAMERA_DRIFT + PAPER_OBJECT_DRIFT
    wanted = []
    if ROTATING in plan.recordings and not plan.quick:
        for seed in plan.seeds:
            run = Run(Sequence(ROTATING, seed, frames=frames, recorded=True), object_prior=NONE, drift=drift)
            wanted.append(Case.of(run, recording=ROTATING, camera_prior="drift 6 cm/s", seed=seed))
        run = Run(Sequence(ROTATING, 1, frames=frames, recorded=True), camera_prior=NONE, object_prior=NONE)
        wanted.append(Case.of(run, recording=ROTATING, camera_prior="none", seed=1))
    if WALKING in plan.recordings:
        run = Run(Sequence(WALKING, 1, frames=frames, recorded=True), camera_prior=NONE, object_prior=NONE)
        wanted.append(Case.of(run, recording=WALKING, camera_prior="none", seed=1))
    return wanted


def measure(finished, row):
    judged = [f for f in finished.each_frame()[FIRST_JUDGED_FRAME:] if f["iou"] is not None]
    masks = stats.pooled(judged)
    return {"iou_judged": masks["iou"], "iou_worst_frame": min((f["iou"] for f in judged), default=None),
            "judged_frames": masks["frames"]}


def report(rows, out):
    if not rows:
        out.text("No recording was found.")
        return
    out.text("fr1_rpy: the truth with simulated drift as prior (one run a drift seed), and no prior. "
             "walking_halfsphere: against the hand-drawn masks, from the fifth frame on, over the pixels of all of "
             "them.")
    out.table(rows, ("recording", "camera_prior"),
              [("prior ATE SE3, cm", "prior_ate_se3_cm", 2)] + CAMERA_COLUMNS
              + [("IoU", "iou_judged", 3), ("IoU, worst frame", "iou_worst_frame", 3),
                 ("frames with masks", "judged_frames", 0)])
    shown = [r for r in rows if r["camera_ate_se3_cm"] is not None]
    if shown:
        out.plot("ate", bars, shown, "camera_prior", "recording", "camera_ate_se3_cm", "ATE, aligned in SE(3), cm")
    masked = [r for r in rows if r["iou_judged"] is not None]
    if masked:
        out.plot("iou", bars, masked, "camera_prior", "recording", "iou_judged", "IoU")
