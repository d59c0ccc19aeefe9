# SPDX-License-Identifier: BSD-3-Clause
"""Never worse than the prior when that is good, never worse than vision alone when it is bad."""
from .. import stats, tables
from ..plan import CAMERA_SCENES
from ..report import CAMERA_COLUMNS, OBJECT_COLUMNS, boxes
from ..runs import FROZEN, JUMPING, NONE, PAPER_CAMERA_DRIFT, PAPER_OBJECT_DRIFT, Case, Run
from .drift import rotation

TITLE = "Never worse than the prior, nor than vision alone"

GOOD_DRIFT = (0.005, 0.02)  # m/s, rad/s: the good prior
BAD_DRIFT = (0.34, rotation(34))

# name: how the run differs, and what its errors are divided by ("prior" or another case of the same sequence)
CASES = {
    "good prior": (dict(drift=GOOD_DRIFT + PAPER_OBJECT_DRIFT), "prior"),
    "drift 34 cm/s": (dict(drift=BAD_DRIFT + PAPER_OBJECT_DRIFT), "no camera prior"),
    "frozen": (dict(camera_prior=FROZEN), "no camera prior"),
    "jumping": (dict(camera_prior=JUMPING), "no camera prior"),
    "object prior frozen": (dict(object_prior=FROZEN), "no object prior"),
    "object prior jumping": (dict(object_prior=JUMPING), "no object prior"),
    "no camera prior": (dict(camera_prior=NONE), None),
    "no object prior": (dict(object_prior=NONE), None),
}
QUICK_CASES = ("good prior", "frozen", "no camera prior")
ERRORS = {"ATE": "ate_first_cm", "RPE": "rpe_cm_per_s"}
MEDIAN_BOUND, TAIL_BOUND = 1.1, 1.5


def cases(plan):
    names = QUICK_CASES if plan.quick else tuple(CASES)
    return [Case.of(Run(plan.sequence(scene, seed), **CASES[name][0]), scene=scene, case=name, seed=seed)
            for scene in plan.choose(CAMERA_SCENES, quick=("sideway",)) for seed in plan.seeds for name in names]


def measure(finished, row):
    return {}


def add_ratios(rows):
    """Errors over those of the case's reference, both at least 5 mm (5 mm/s)."""
    known = {(r["scene"], r["seed"], r["case"]): r for r in rows}
    for row in rows:
        against = CASES[row["case"]][1]
        other = row if against == "prior" else known.get((row["scene"], row["seed"], against))
        prefix = "prior" if against == "prior" else "camera"
        for name, key in ERRORS.items():
            reference = other.get(f"{prefix}_{key}") if other else None
            row[f"{name}_ratio"] = stats.floored_ratio(row[f"camera_{key}"], reference)


def bounds(rows, error):
    """(median, 95th percentile) of an error's ratio."""
    values = [r.get(f"{error}_ratio") for r in rows]
    return stats.median(values), stats.quantile(values, 0.95)


def ratio_cell(error):
    def cell(rows):
        middle, tail = bounds(rows, error)
        return "-" if middle is None else f"{middle:.2f} / {tail:.2f}"
    return cell


def report(rows, out):
    add_ratios(rows)
    compared = [r for r in rows if CASES[r["case"]][1]]
    out.text("Good: 0.5 cm/s, 0.02 rad/s, against the prior alone. Bad: 34 cm/s with "
             f"{BAD_DRIFT[1]:g} rad/s; the given prior ({100 * PAPER_CAMERA_DRIFT[0]:g} cm/s) frozen from the middle "
             "on; with jumps of 10 cm every one to three seconds; against the same run without that prior. Ratios "
             "of max(error, 5 mm): median / 95th percentile; to reach: 1.1 / 1.5.")
    out.table(compared, ("case",), [("ATE ratio", ratio_cell("ATE")), ("RPE ratio", ratio_cell("RPE"))])
    out.table(compared, ("scene", "case"), [("ATE ratio", ratio_cell("ATE")), ("RPE ratio", ratio_cell("RPE"))])
    out.table(rows, ("scene", "case"), CAMERA_COLUMNS + OBJECT_COLUMNS
              + [("prior ATE, cm", "prior_ate_first_cm", 2), ("prior RPE, cm/s", "prior_rpe_cm_per_s", 2)])
    for error in ERRORS:
        out.plot(error.lower(), boxes, compared, "case", f"{error}_ratio", f"{error} / reference",
                 limits=(MEDIAN_BOUND, TAIL_BOUND), log=True)


def worst(rows):
    """{case: (largest median, largest 95th percentile of both errors)} of the compared cases."""
    result = {}
    for (case,), group in tables.grouped([r for r in rows if CASES[r["case"]][1]], ("case",)):
        both = [bounds(group, error) for error in ERRORS]
        if all(b[0] is not None for b in both):
            result[case] = max(b[0] for b in both), max(b[1] for b in both)
    return result
