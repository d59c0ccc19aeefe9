# SPDX-License-Identifier: BSD-3-Clause
"""Accuracy and completeness of both surfel models against the true surfaces."""
from ..plan import CAMERA_SCENES
from ..report import bars
from ..runs import Case, Run

TITLE = "Models: accuracy, and completeness of what was seen"


def cases(plan):
    return [Case.of(Run(plan.sequence(scene, seed)), scene=scene, seed=seed)
            for scene in plan.choose(CAMERA_SCENES, quick=("sideway",)) for seed in plan.seeds]


def measure(finished, row):
    return {}


def report(rows, out):
    out.text("Accuracy: distance of the model's surfels to the true surface, and the share within 2 cm. Completeness: "
             "share of the true surface's points that have a surfel within 2 cm, of the points that the depth image "
             "showed in at least three of every fifth frames (rf-simulate writes only those).")
    columns = []
    for body, key in (("static", "static_model"), ("object", "object_model")):
        columns += [(f"{body}: median, cm", f"{key}_median_cm", 2), (f"{body}: within 2 cm", f"{key}_share_2cm", 3),
                    (f"{body}: completeness", f"{key}_completeness", 3)]
    out.table(rows, ("scene",), columns)
    shares = [{"scene": r["scene"], "what": f"{body}, {what}", "share": r[f"{body}_model_{key}"]}
              for body in ("static", "object") for what, key in (("within 2 cm", "share_2cm"),
                                                                 ("complete", "completeness")) for r in rows]
    out.plot("shares", bars, shares, "scene", "what", "share", "share")
