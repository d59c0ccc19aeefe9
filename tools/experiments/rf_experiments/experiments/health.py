# SPDX-License-Identifier: BSD-3-Clause
"""Whether health says what happens: injected events, poses that are off, covariances that fit the errors."""
import dataclasses

from .. import derive, measures, stats, tables
from ..report import bars
from ..runs import Case, Run

TITLE = "Health: events reported, poses off while tracked, consistency"

SCENES = ("overtake", "sideway")
UNDISTURBED = "none"


def cases(plan):
    wanted = []
    for scene in plan.choose(SCENES, quick=("sideway",)):
        for seed in plan.seeds:
            sequence = plan.sequence(scene, seed)
            for event in ("lens covered",) if plan.quick else derive.EVENTS:
                wanted.append(Case.of(Run(sequence, event=event), scene=scene, event=event, noise=1.0, seed=seed))
            for noise in plan.noises[:1] if plan.quick else plan.noises:
                run = Run(dataclasses.replace(sequence, noise=noise))
                wanted.append(Case.of(run, scene=scene, event=UNDISTURBED, noise=noise, seed=seed))
    return wanted


def measure(finished, row):
    frames = finished.each_frame()
    result = {f"share_{state}": stats.share(f["health"] == state for f in frames)
              for state in ("tracked", "degraded", "prior-only", "lost")}
    event_frame = finished.sequence.get("event_frame")
    if event_frame is None:
        return {**result, "event_frame": None, "report_delay": None, "reported": None}
    delay = measures.report_delay(frames, event_frame)
    before = stats.share(f["health"] != "tracked" for f in frames[event_frame - 30:event_frame])
    return {**result, "event_frame": event_frame, "report_delay": delay, "reported": delay is not None,
            "false_alarms_before": before}


def report(rows, out):
    out.text("Lens covered: black colour and no depth for 15 frames. Black colour: 10 frames. Depth gone: 15 frames. "
             "Teleport: the camera stands a metre further on, the priors do not notice. Reported: camera health is "
             "not `tracked` within 5 frames. Off: frames with an error above 10 cm (first pose) while health says "
             "tracked. NEES: normalised error squared per degree of freedom, 1 when covariances are right; noise is a "
             "factor on the simulated sensor's.")
    out.table([r for r in rows if r["event"] != UNDISTURBED], ("event",),
              [("reported", tables.per_cent("reported")), ("delay, frames", "report_delay", 0),
               ("not tracked in the second before", "false_alarms_before", 2)])
    out.table(rows, ("scene", "event", "noise"),
              [("off while tracked", tables.total("off_while_tracked")),
               ("object off", tables.total("object_off_while_tracked")), ("tracked", "share_tracked", 3),
               ("degraded", "share_degraded", 3), ("prior-only", "share_prior-only", 3), ("lost", "share_lost", 3),
               ("ATE 1st, cm", "camera_ate_first_cm", 2), ("NEES camera", "camera_nees", 2),
               ("NEES object", "object_nees", 2)])
    quiet = [r for r in rows if r["noise"] == 1]
    out.plot("tracked", bars, quiet, "event", "scene", "share_tracked", "share of frames that are tracked")
    undisturbed = [r for r in rows if r["event"] == UNDISTURBED]
    for body in ("camera", "object"):
        if any(r[f"{body}_nees"] is not None for r in undisturbed):
            out.plot(f"nees-{body}", bars, undisturbed, "noise", "scene", f"{body}_nees",
                     f"NEES of the {body} per degree of freedom", log=True)
