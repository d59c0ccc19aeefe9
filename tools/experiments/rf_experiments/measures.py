# SPDX-License-Identifier: BSD-3-Clause
"""From the files of a finished run to the numbers of a table's row."""
import csv
import json

from . import stats

LOST_METRES = 0.10  # a pose further off while health says tracked is a failure
FRAMES_TO_REPORT = 5
MICROSECONDS = 1e6


class Finished:
    """The files of one cache entry, read when asked for."""

    def __init__(self, folder):
        self.folder = folder
        self.evaluation = json.loads((folder / "evaluation.json").read_text())
        self.sequence = json.loads((folder / "sequence.json").read_text())

    def number(self, *path):
        """A number of evaluation.json; None where a part of the path is absent."""
        value = self.evaluation
        for key in path:
            value = value.get(key) if isinstance(value, dict) else None
            if isinstance(value, dict) and value.get("count") == 0:
                return None  # statistics of nothing
        return None if value is None else float(value)

    def each_frame(self):
        """Rows of each_frame.csv with numbers, None for empty cells, and health from frames.csv."""
        with open(self.folder / "each_frame.csv", newline="") as file:
            rows = [{k: float(v) if v else None for k, v in row.items()} for row in csv.DictReader(file)]
        health = {round(int(r["utime"])): r for r in self.frames()}
        for row in rows:
            state = health.get(round(row["timestamp"] * MICROSECONDS), {})
            row["health"] = state.get("health")
            row["object_health"] = state.get("object_health")
        return rows

    def frames(self):
        with open(self.folder / "frames.csv", newline="") as file:
            return list(csv.DictReader(file))


# name in the tables, path in evaluation.json
NUMBERS = {
    "camera_ate_first_cm": ("camera", "ate_first_cm", "rmse"),
    "camera_ate_se3_cm": ("camera", "ate_aligned_cm", "rmse"),
    "camera_rpe_cm_per_s": ("camera", "rpe_cm_per_s", "rmse"),
    "camera_rpe_deg_per_s": ("camera", "rpe_deg_per_s", "rmse"),
    "camera_coverage": ("camera", "coverage"),
    "prior_ate_first_cm": ("camera_prior", "ate_first_cm", "rmse"),
    "prior_ate_se3_cm": ("camera_prior", "ate_aligned_cm", "rmse"),
    "prior_rpe_cm_per_s": ("camera_prior", "rpe_cm_per_s", "rmse"),
    "prior_rpe_deg_per_s": ("camera_prior", "rpe_deg_per_s", "rmse"),
    "object_ate_first_cm": ("object", "ate_first_cm", "rmse"),
    "object_rpe_cm_per_s": ("object", "rpe_cm_per_s", "rmse"),
    "object_coverage": ("object", "coverage"),
    "object_prior_ate_first_cm": ("object_prior", "ate_first_cm", "rmse"),
    "object_prior_rpe_cm_per_s": ("object_prior", "rpe_cm_per_s", "rmse"),
    "iou_moving": ("segmentation_moving", "iou"),
    "static_accuracy_moving": ("segmentation_moving", "static_accuracy"),
    "dynamic_accuracy_moving": ("segmentation_moving", "dynamic_accuracy"),
    "iou_fast": ("segmentation_fast", "iou"),
    "static_model_median_cm": ("static_model", "accuracy_median_cm"),
    "static_model_share_2cm": ("static_model", "accuracy_share"),
    "static_model_completeness": ("static_model", "completeness"),
    "static_on_moving_share": ("static_on_moving", "share"),
    "object_model_median_cm": ("object_model", "accuracy_median_cm"),
    "object_model_share_2cm": ("object_model", "accuracy_share"),
    "object_model_completeness": ("object_model", "completeness"),
    "camera_nees": ("camera", "nees", "pose", "mean"),
    "object_nees": ("object", "nees", "pose", "mean"),
}


def common(finished):
    """The numbers that every experiment writes."""
    row = {name: finished.number(*path) for name, path in NUMBERS.items()}
    row["frames"] = finished.sequence["frames"]
    row["camera_path_m"] = finished.sequence.get("camera_path_m")
    row["frame_ms_median"] = stats.median(float(r["segment_ms"]) + float(r["fuse_ms"])
                                          for r in finished.frames() if r["segment_ms"] and r["fuse_ms"])
    frames = finished.each_frame()
    row["off_while_tracked"] = off_while_tracked(frames, "health", "camera_error_m")
    row["object_off_while_tracked"] = off_while_tracked(frames, "object_health", "object_error_m")
    return row


def off_while_tracked(frames, health, error):
    """Frames whose pose is more than 10 cm off while its health says tracked."""
    return sum(1 for f in frames if f[health] == "tracked" and (f[error] or 0.0) > LOST_METRES)


ONSET_METRES = 0.01
ONSET_FRAMES = 3
ONSET_IOU = 0.8
ONSET_ACCURACY = 0.9


def is_split(frame):
    """Whether the masks of a frame tell the two bodies apart."""
    return (frame["iou"] is not None and frame["iou"] >= ONSET_IOU and frame["static_accuracy"] >= ONSET_ACCURACY
            and frame["dynamic_accuracy"] >= ONSET_ACCURACY)


def onset(frames):
    """When the object's first motion is found: frames from 1 cm of displacement to the first right mask (negative:
    before), whether that is within 3, and the share of right masks from then on while it moves."""
    first = next((i for i, f in enumerate(frames) if (f["object_displacement_m"] or 0.0) >= ONSET_METRES), None)
    if first is None:
        return {"onset_frame": None, "onset_delay": None, "onset_found": None, "onset_held": None}
    moving = next(i for i, f in enumerate(frames) if (f["object_displacement_m"] or 0.0) > 0)
    found = next((i for i in range(moving, len(frames)) if is_split(frames[i])), None)
    after = [is_split(f) for f in frames[first + ONSET_FRAMES:] if (f["object_speed_m_per_s"] or 0.0) > 0.01]
    return {"onset_frame": first, "onset_delay": None if found is None else found - first,
            "onset_found": found is not None and found - first <= ONSET_FRAMES,
            "onset_held": stats.share(after), "onset_share": frames[first]["dynamic_share"],
            "onset_iou": frames[min(first + ONSET_FRAMES, len(frames) - 1)]["iou"]}


GONE_SHARE = 0.005
BACK_SHARE = 0.02
COMEBACK_FRAMES = 15  # half a second


def longest_absence(frames):
    """(first, last) index of the longest time without the object after it has moved; None when there is none."""
    moved = next((i for i, f in enumerate(frames) if (f["object_displacement_m"] or 0.0) >= ONSET_METRES), len(frames))
    best, begin = None, None
    for i in range(moved, len(frames)):
        gone = frames[i]["dynamic_share"] is not None and frames[i]["dynamic_share"] < GONE_SHARE
        begin = (i if begin is None else begin) if gone else None
        if gone and (best is None or i - begin > best[1] - best[0]):
            best = begin, i
    return best


def comeback(frames):
    """Whether an object that was out of sight is found again: frames from its return to the first right mask, and
    how far its pose is off half a second after the return."""
    absence = longest_absence(frames)
    if absence is None:
        return {"gone_frames": 0, "comeback_delay": None, "found_again": None, "comeback_object_error_cm": None}
    back = next((i for i in range(absence[1] + 1, len(frames))
                 if (frames[i]["dynamic_share"] or 0.0) >= BACK_SHARE), None)
    found = None if back is None else next((i for i in range(back, len(frames)) if is_split(frames[i])), None)
    later = None if back is None else frames[min(back + COMEBACK_FRAMES, len(frames) - 1)]["object_error_m"]
    return {"gone_frames": absence[1] - absence[0] + 1, "comeback_delay": None if found is None else found - back,
            "found_again": None if back is None else found is not None and found - back <= COMEBACK_FRAMES,
            "comeback_object_error_cm": None if later is None else 100 * later}


def report_delay(frames, event_frame):
    """Frames from an event to the first whose camera health is not `tracked`; None: never within 5."""
    for i, frame in enumerate(frames[event_frame:event_frame + FRAMES_TO_REPORT + 1]):
        if frame["health"] != "tracked":
            return i
    return None


def between_speeds(frames, low, high):
    """Frames whose object's true speed lies in (low, high], m/s."""
    return [f for f in frames if f["object_speed_m_per_s"] is not None and low < f["object_speed_m_per_s"] <= high]
