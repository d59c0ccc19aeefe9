# SPDX-License-Identifier: BSD-3-Clause
"""The paper's main table: every method on the four camera sequences with the paper's drift."""
from ..plan import BASELINES, CAMERA_SCENES
from ..report import CAMERA_COLUMNS, MASK_COLUMNS, OBJECT_COLUMNS, bars
from ..runs import Case, Run

TITLE = "Camera sequences: ATE and RPE of every method"


def cases(plan):
    return [Case.of(Run(plan.sequence(scene, seed), mode=mode), scene=scene, method=mode, seed=seed)
            for scene in plan.choose(CAMERA_SCENES, quick=("sideway",))
            for mode, seeds in plan.modes(BASELINES) for seed in seeds]


def measure(finished, row):
    return {}


def with_prior(rows, ours="rigidfusion"):
    """Before the methods the prior itself, judged at the same frames as the runs that had it."""
    names = ("ate_first_cm", "ate_se3_cm", "rpe_cm_per_s", "rpe_deg_per_s")
    prior = [{**{k: row[k] for k in ("scene", "seed", "run", "frames", "camera_path_m")}, "method": "prior",
              **{f"camera_{n}": row[f"prior_{n}"] for n in names}} for row in rows if row["method"] == ours]
    return prior + rows


def by_scene(rows):
    """Rows of a scene together, each method's after the other."""
    order = {s: i for i, s in enumerate(dict.fromkeys(r["scene"] for r in rows))}
    return sorted(rows, key=lambda r: order[r["scene"]])


def report(rows, out):
    every = by_scene(with_prior(rows))
    out.text("Drift of the camera prior 6 cm/s, 0.4 rad/s, of the object prior 1.5 cm/s, 0.1 rad/s. ATE is the RMSE "
             "of positions, aligned at the first pose or in SE(3); RPE that of the motion over 1 s. Medians over "
             "seeds with quartiles; masks over all frames in which the object moves.")
    out.table(every, ("scene", "method"), CAMERA_COLUMNS + OBJECT_COLUMNS + MASK_COLUMNS)
    out.plot("ate", bars, every, "scene", "method", "camera_ate_first_cm", "ATE, aligned at the first pose, cm",
             log=True)
    out.plot("rpe", bars, every, "scene", "method", "camera_rpe_cm_per_s", "RPE, cm/s", log=True)
