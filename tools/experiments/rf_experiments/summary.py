# SPDX-License-Identifier: BSD-3-Clause
"""The figures that are to be reached, each with what the experiments found."""
from . import stats, tables
from .experiments import drift, onset, priors, real, size

OURS = "rigidfusion"


class Figure:
    """One line: what, the paper's figure, the bound, and how it is read from the rows of one experiment."""

    def __init__(self, what, paper, bound, experiment, read, digits=2, at_least=False):
        self.what, self.paper, self.bound, self.experiment = what, paper, bound, experiment
        self.read, self.digits, self.at_least = read, digits, at_least

    def line(self, rows):
        sign = "at least" if self.at_least else "at most"
        head = [self.what, self.paper, f"{sign} {self.bound:g}"]
        if not rows:
            return head + ["not run", ""]
        value, count = self.read(rows)
        if value is None:
            return head + ["none", "missed" if count else "not run"]
        reached = value >= self.bound if self.at_least else value <= self.bound
        return head + [f"{value:.{self.digits}f} (n {count})", "reached" if reached else "missed"]


def chosen(rows, conditions):
    return [r for r in rows if all(r.get(k) == v for k, v in conditions.items())]


def middle(key, **conditions):
    """Median of a column over the rows that meet the conditions, and how many there are."""
    def read(rows):
        values = stats.present(r.get(key) for r in chosen(rows, conditions))
        return stats.median(values), len(values)
    return read


def scaled(factor, read):
    def scale(rows):
        value, count = read(rows)
        return (None if value is None else factor * value), count
    return scale


def over_groups(pick, group, key, **conditions):
    """The smallest (pick=min) or largest (max) of the groups' medians."""
    def read(rows):
        own = chosen(rows, conditions)
        medians = stats.present(stats.median(r.get(key) for r in g) for _, g in tables.grouped(own, (group,)))
        return pick(medians, default=None), len(own)
    return read


def part(key, **conditions):
    """Per cent of the rows in which the key is true."""
    def read(rows):
        own = [r for r in chosen(rows, conditions) if r.get(key) is not None]
        value = stats.share(r[key] for r in own)
        return (None if value is None else 100 * value), len(own)
    return read


def count_of(key):
    def read(rows):
        return sum(r.get(key) or 0 for r in rows), len(rows)
    return read


def worst_ratio(case, place):
    """A case's worst ratio: place 0 the median, 1 the 95th percentile."""
    def read(rows):
        found = priors.worst(rows).get(case)
        return (found[place] if found else None), len(chosen(rows, {"case": case}))
    return read


def onset_worst(rows):
    """The share found at the worst size."""
    shares = stats.present(onset.found_share(rows).values())
    return (100 * min(shares) if shares else None), len(rows)


def camera_figures():
    scenes = {"straight": (3.84, 1.5, 3, 5.54), "orbit": (5.74, 1.5, 3, 5.1), "overtake": (5.39, 1.5, 3, 4.78),
              "sideway": (13.1, 2.5, 4, 8.03)}
    for scene, (ate, se3, first, rpe) in scenes.items():
        own = {"scene": scene, "method": OURS}
        yield Figure(f"camera ATE {scene}, SE3, cm", f"{ate:g}", se3, "camera", middle("camera_ate_se3_cm", **own))
        yield Figure(f"camera ATE {scene}, first pose, cm", "", first, "camera", middle("camera_ate_first_cm", **own))
        yield Figure(f"camera RPE {scene}, cm/s", f"{rpe:g}", 1, "camera", middle("camera_rpe_cm_per_s", **own))
        yield Figure(f"object ATE {scene}, first pose, cm", "not given", 3, "camera",
                     middle("object_ate_first_cm", **own))


def prior_figures():
    for case in (c for c, (_, against) in priors.CASES.items() if against):
        yield Figure(f"prior, {case}: worst of ATE and RPE ratio, median", "", priors.MEDIAN_BOUND, "priors",
                     worst_ratio(case, 0))
        yield Figure(f"prior, {case}: the same, 95th percentile", "", priors.TAIL_BOUND, "priors",
                     worst_ratio(case, 1))


def mask_figures():
    for scene, bound in (("straight", 0.85), ("orbit", 0.93), ("overtake", 0.93), ("sideway", 0.93)):
        yield Figure(f"dynamic IoU {scene}, all moving frames", "", bound, "masks", middle("iou_moving", scene=scene),
                     3, at_least=True)
    yield Figure("dynamic IoU, worst size", "", 0.9, "size", over_groups(min, "size", "iou_moving", method=OURS),
                 3, at_least=True)


def other_figures():
    yield Figure("robot-like sequences: ATE / wheel odometry's", "2.2 to 4.4", 0.7, "robot",
                 middle("ate_ratio", method=OURS))
    yield Figure("largest object size still tracked", "0.75", 0.85, "size",
                 lambda rows: (size.largest_tracked(rows), len(chosen(rows, {"method": OURS}))), at_least=True)
    yield Figure("prior drift tolerated without object prior, cm/s", "17", 34, "drift",
                 lambda rows: (drift.tolerated(rows, "none"), len(chosen(rows, {"object_prior": "none"}))), 0,
                 at_least=True)
    yield Figure("object model: accuracy (median), mm", "not given", 5, "models",
                 scaled(10, middle("object_model_median_cm")), 1)
    yield Figure("object model: completeness at 2 cm of what was seen, %", "not given", 90, "models",
                 scaled(100, middle("object_model_completeness")), 1, at_least=True)
    yield Figure("onset found within 3 frames at the worst size, % of the seeds", "", 95, "onset", onset_worst, 0,
                 at_least=True)
    yield Figure("static loop: end error, % of its length", "", 1, "loop",
                 scaled(100, middle("end_error_share", camera_prior="paper's drift")))
    yield Figure("static loop without prior: end error, % of its length", "", 1, "loop",
                 scaled(100, middle("end_error_share", camera_prior="none")))
    yield Figure("static loop: map within 2 cm, %", "", 98, "loop",
                 scaled(100, middle("static_model_share_2cm", camera_prior="paper's drift")), 1, at_least=True)
    yield Figure("events reported within 5 frames, %", "", 100, "health", part("reported"), 0, at_least=True)
    yield Figure("camera poses off by more than 10 cm while tracked", "", 0, "health", count_of("off_while_tracked"), 0)
    yield Figure("object poses off by more than 10 cm while tracked", "", 0, "health",
                 count_of("object_off_while_tracked"), 0)
    for body in ("camera", "object"):
        of_level = ("noise", f"{body}_nees")
        yield Figure(f"NEES per degree of freedom, {body}: highest of the noise levels", "", 2, "health",
                     over_groups(max, *of_level, event="none"))
        yield Figure(f"NEES per degree of freedom, {body}: lowest of the noise levels", "", 0.5, "health",
                     over_groups(min, *of_level, event="none"), at_least=True)
    yield Figure("object found again within half a second of its return, %", "", 100, "states", part("found_again"), 0,
                 at_least=True)
    yield Figure("two objects: camera ATE, cm", "", 5, "objects",
                 middle("camera_ate_first_cm", object_prior="of the first body"))


def recorded(prefix, key, **conditions):
    """Median over the longest recording with that prefix."""
    def read(rows):
        return middle(key)(chosen(real.longest(rows, prefix, key), conditions))
    return read


def real_figures():
    for prior, bound in (("drift 6 cm/s", 1.5), ("none", 2)):
        yield Figure(f"fr1_rpy, camera prior: {prior}: ATE SE3, cm", "", bound, "real",
                     recorded(real.ROTATING, "camera_ate_se3_cm", camera_prior=prior))
    yield Figure("walking_halfsphere: IoU from the fifth frame on", "", 0.7, "real",
                 recorded(real.WALKING, "iou_judged"), 3, at_least=True)
    yield Figure("walking_halfsphere: static map on people, % of its surfels", "", 2, "real",
                 scaled(100, recorded(real.WALKING, "static_on_moving_share")), 1)


def figures():
    return [*camera_figures(), *other_figures(), *real_figures(), *mask_figures(), *prior_figures()]


def off_line(name, rows):
    """Runs of our mode, and those in which a pose was more than 10 cm off while its health said tracked."""
    own = list({r["run"]: r for r in rows if r.get("method", OURS) == OURS}.values())
    cells = [name, str(len(own))]
    for key in ("off_while_tracked", "object_off_while_tracked"):
        frames = [r[key] for r in own if r.get(key)]
        cells += [str(len(frames)), str(sum(frames))]
    return cells


def off_table(known):
    """The same for every experiment; experiments share runs, and the last line has each once."""
    lines = [off_line(name, rows) for name, rows in known.items()]
    every = off_line("all", [row for rows in known.values() for row in rows])
    return tables.markdown(["tracked, but more than 10 cm off", "runs", "camera: runs", "frames", "object: runs",
                            "frames"], [*lines, every])


def write(folder, names, command, notes):
    """summary.md from the tables in the folder, those of earlier calls too."""
    known = {n: tables.read_csv(folder / f"{n}.csv") for n in names if (folder / f"{n}.csv").exists()}
    body = [figure.line(known.get(figure.experiment)) for figure in figures()]
    reached = sum(1 for line in body if line[-1] == "reached")
    missed = sum(1 for line in body if line[-1] == "missed")
    text = ["# Figures to reach\n", f"`{command}`\n",
            f"Medians over n runs. {reached} reached, {missed} missed, {len(body) - reached - missed} not measured.\n",
            tables.markdown(["figure", "paper's best", "to reach", "found", ""], body),
            off_table(known),
            "Tables: " + ", ".join(f"[{n}]({n}.md)" for n in known) + "\n"]
    (folder / "summary.md").write_text("\n".join(text + [f"- {note}" for note in notes]) + ("\n" if notes else ""))
