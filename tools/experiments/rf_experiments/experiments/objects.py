# SPDX-License-Identifier: BSD-3-Clause
"""Two bodies that move independently, one body's model for both."""
from ..report import CAMERA_COLUMNS, MASK_COLUMNS, bars
from ..runs import GIVEN, NONE, Case, Run

TITLE = "Two objects: the static world against both"


def cases(plan):
    return [Case.of(Run(plan.sequence("two_objects", seed), object_prior=kind), scene="two_objects",
                    object_prior=name, seed=seed)
            for name, kind in (("of the first body", GIVEN), ("none", NONE)) if not (plan.quick and kind == NONE)
            for seed in plan.seeds]


def measure(finished, row):
    return {}


def report(rows, out):
    out.text("Paper's drift. The masks count both bodies as dynamic. To reach: camera ATE of at most 5 cm.")
    out.table(rows, ("object_prior",), CAMERA_COLUMNS + MASK_COLUMNS)
    out.plot("ate", bars, rows, "object_prior", "scene", "camera_ate_first_cm", "ATE, cm")
