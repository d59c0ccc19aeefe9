# SPDX-License-Identifier: BSD-3-Clause
"""A carton that a hand waves close to a camera at rest."""
from ..report import CAMERA_COLUMNS, MASK_COLUMNS, OBJECT_COLUMNS, bars
from ..runs import GIVEN, NONE, Case, Run

TITLE = "Held object: hand and carton"


def cases(plan):
    return [Case.of(Run(plan.sequence("held", seed), object_prior=kind), scene="held", object_prior=name, seed=seed)
            for name, kind in (("paper's drift", GIVEN), ("none", NONE)) if not (plan.quick and kind == NONE)
            for seed in plan.seeds]


def measure(finished, row):
    return {}


def report(rows, out):
    out.text("Paper's drift of the camera prior although the camera rests.")
    out.table(rows, ("object_prior",), CAMERA_COLUMNS + OBJECT_COLUMNS + MASK_COLUMNS)
    out.plot("iou", bars, rows, "object_prior", "scene", "iou_moving", "IoU")
