# SPDX-License-Identifier: BSD-3-Clause
"""A static loop with a full turn: how far its end is off, and whether a wall stands twice."""
from ..report import CAMERA_COLUMNS, bars
from ..runs import GIVEN, NONE, Case, Run

TITLE = "Static loop: end error and map"


def cases(plan):
    return [Case.of(Run(plan.sequence("loop", seed), camera_prior=kind), scene="loop", camera_prior=name, seed=seed)
            for name, kind in (("paper's drift", GIVEN), ("none", NONE)) if not (plan.quick and kind == NONE)
            for seed in plan.seeds]


def measure(finished, row):
    known = [f["camera_error_m"] for f in finished.each_frame() if f["camera_error_m"] is not None]
    if not known or not row["camera_path_m"]:
        return {"end_error_cm": None, "end_error_share": None}
    return {"end_error_cm": 100 * known[-1], "end_error_share": known[-1] / row["camera_path_m"]}


def report(rows, out):
    out.text("The camera walks a circle with a full turn and comes back; nothing else moves. End error: distance of "
             "the last pose from the true one, aligned at the first; share: of the path's length (to reach: 1 %). "
             "Map: share of the static model's surfels within 2 cm of a true surface (to reach: 98 %).")
    out.table(rows, ("camera_prior",),
              [("end error, cm", "end_error_cm", 2), ("share of the path", "end_error_share", 4),
               ("map within 2 cm", "static_model_share_2cm", 4), ("map complete", "static_model_completeness", 3)]
              + CAMERA_COLUMNS)
    out.plot("end", bars, rows, "camera_prior", "scene", "end_error_cm", "end error, cm")
