# SPDX-License-Identifier: BSD-3-Clause
"""One module an experiment. Each has TITLE (a line for people), cases(plan) (the rows to make), measure(finished,
row) (numbers beside the common ones) and report(rows, report) (tables and figures)."""
from . import camera, drift, health, held, loop, masks, models, objects, onset, priors, real, robot, size, states

ALL = {"camera": camera, "robot": robot, "size": size, "drift": drift, "priors": priors, "onset": onset,
       "masks": masks, "models": models, "health": health, "loop": loop, "objects": objects, "held": held,
       "states": states, "real": real}
