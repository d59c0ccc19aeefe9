# SPDX-License-Identifier: BSD-3-Clause
"""Numbers over runs and over frames. Absent values are None and are left out."""
import math

FLOOR_CM = 0.5  # errors below 5 mm count as 5 mm when two are compared


def present(values):
    return [v for v in values if v is not None and not math.isnan(v)]


def quantile(values, share):
    """Linear between the order statistics, the ends included; None of an empty list."""
    ordered = sorted(present(values))
    if not ordered:
        return None
    at = share * (len(ordered) - 1)
    low = math.floor(at)
    high = min(low + 1, len(ordered) - 1)
    return ordered[low] + (at - low) * (ordered[high] - ordered[low])


def median(values):
    return quantile(values, 0.5)


def share(flags):
    """Of the flags that are set; None of an empty list."""
    known = [bool(f) for f in flags if f is not None]
    return sum(known) / len(known) if known else None


def floored_ratio(value, reference, floor=FLOOR_CM):
    """Of two errors, each at least the floor: below it a difference means nothing."""
    if value is None or reference is None:
        return None
    return max(value, floor) / max(reference, floor)


def pooled(frames):
    """IoU of the dynamic class and both accuracies over the pixels of several frames together; `frames` are
    dictionaries with the four counts. None where no frame has them."""
    names = ("static_right", "static_wrong", "dynamic_right", "dynamic_wrong")
    counted = [f for f in frames if f.get("static_right") is not None]
    if not counted:
        return {"iou": None, "static_accuracy": None, "dynamic_accuracy": None, "frames": 0}
    sums = {n: sum(f[n] for f in counted) for n in names}

    def part(right, *wrong):
        total = sums[right] + sum(sums[w] for w in wrong)
        return sums[right] / total if total else 1.0

    return {"iou": part("dynamic_right", "dynamic_wrong", "static_wrong"),
            "static_accuracy": part("static_right", "static_wrong"),
            "dynamic_accuracy": part("dynamic_right", "dynamic_wrong"), "frames": len(counted)}
