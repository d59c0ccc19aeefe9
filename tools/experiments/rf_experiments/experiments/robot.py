# SPDX-License-Identifier: BSD-3-Clause
"""The same sequences with a camera prior as good as wheel odometry: what the paper's method made worse."""
from .. import stats
from ..plan import BASELINES, CAMERA_SCENES
from ..report import CAMERA_COLUMNS, OBJECT_COLUMNS, bars, boxes
from ..runs import PAPER_OBJECT_DRIFT, Case, Run
from .camera import by_scene, with_prior

TITLE = "Robot-like sequences: the prior is wheel odometry"

# m/s, rad/s: over 60 drift seeds ATE 2.1 to 4.0 cm (10th to 90th percentile, median 3.0) over the four paths.
ODOMETRY_DRIFT = (0.008, 0.0267)


def cases(plan):
    return [Case.of(Run(plan.sequence(scene, seed), mode=mode, drift=ODOMETRY_DRIFT + PAPER_OBJECT_DRIFT),
                    scene=scene, method=mode, seed=seed)
            for scene in plan.choose(CAMERA_SCENES, quick=("sideway",))
            for mode, seeds in plan.modes(() if plan.quick else BASELINES) for seed in seeds]


def measure(finished, row):
    ate, prior = row["camera_ate_first_cm"], row["prior_ate_first_cm"]
    return {"ate_ratio": ate / prior if ate is not None and prior else None}


def report(rows, out):
    every = by_scene(with_prior(rows))
    drift = ODOMETRY_DRIFT
    out.text(f"Drift of the camera prior {100 * drift[0]:g} cm/s, {drift[1]:g} rad/s, as wheel odometry: 2 to 4 cm ATE "
             "over the 2 to 3 m of these paths; object prior as the paper's. The ratio is ATE over the prior's.")
    out.table(every, ("scene", "method"), CAMERA_COLUMNS + OBJECT_COLUMNS + [("ATE / prior's", "ate_ratio", 2)])
    ours = stats.present(r["ate_ratio"] for r in rows if r["method"] == "rigidfusion")
    if ours:
        out.text(f"Ours over all scenes: median ratio {stats.median(ours):.2f}, largest {max(ours):.2f}.")
    out.plot("ate", bars, every, "scene", "method", "camera_ate_first_cm", "ATE, cm", log=True)
    out.plot("ratio", boxes, rows, "method", "ate_ratio", "ATE / odometry's ATE", limits=(0.7, 1.0), log=True)
