# SPDX-License-Identifier: BSD-3-Clause
"""What is read from the rows of a run."""
import json
import pathlib
import tempfile
import unittest

from rf_experiments import measures


def frame(i, displacement, iou, accuracy=0.95, speed=0.2, health="tracked", error=0.01):
    return {"timestamp": 10 + i / 30, "object_displacement_m": displacement, "object_speed_m_per_s": speed, "iou": iou,
            "static_accuracy": accuracy, "dynamic_accuracy": accuracy, "dynamic_share": 0.4, "health": health,
            "camera_error_m": error}


def moving(right_from, n=20):
    """At rest for 5 frames, then 4 mm a frame: beyond 1 cm in the frame 7."""
    return [frame(i, max(0, i - 4) * 0.004, 0.9 if i >= right_from else 0.1) for i in range(n)]


class Onset(unittest.TestCase):
    def test_counts_from_one_centimetre(self):
        found = measures.onset(moving(right_from=9))
        self.assertEqual((found["onset_frame"], found["onset_delay"], found["onset_found"]), (7, 2, True))
        self.assertEqual(found["onset_held"], 1.0)

    def test_late_and_never(self):
        self.assertEqual(measures.onset(moving(right_from=11))["onset_found"], False)
        never = measures.onset(moving(right_from=99))
        self.assertEqual((never["onset_delay"], never["onset_found"], never["onset_held"]), (None, False, 0.0))

    def test_found_before_is_early_not_absent(self):
        self.assertEqual(measures.onset(moving(right_from=0))["onset_delay"], -2)

    def test_needs_both_accuracies(self):
        frames = moving(right_from=8)
        for f in frames:
            f["static_accuracy"] = 0.85
        self.assertFalse(measures.onset(frames)["onset_found"])

    def test_an_object_that_rests_has_none(self):
        self.assertIsNone(measures.onset([frame(i, 0.0, 1.0) for i in range(9)])["onset_found"])


class Comeback(unittest.TestCase):
    @staticmethod
    def seen(shares, right_from):
        frames = [frame(i, 0.5, 0.9 if i >= right_from else 0.1, error=0.01) for i in range(len(shares))]
        for f, share in zip(frames, shares):
            f["dynamic_share"] = share
            f["object_error_m"] = 0.04
        return frames

    SHARES = [0.2] * 5 + [0.0] * 2 + [0.2] * 3 + [0.0] * 10 + [0.01] * 2 + [0.1] * 40

    def test_the_longest_absence_counts(self):
        self.assertEqual(measures.longest_absence(self.seen(self.SHARES, 0)), (10, 19))
        found = measures.comeback(self.seen(self.SHARES, 26))
        self.assertEqual((found["gone_frames"], found["comeback_delay"], found["found_again"]), (10, 4, True))
        self.assertAlmostEqual(found["comeback_object_error_cm"], 4.0)

    def test_late_and_never(self):
        self.assertEqual(measures.comeback(self.seen(self.SHARES, 40))["found_again"], False)
        self.assertEqual(measures.comeback(self.seen(self.SHARES, 99))["found_again"], False)
        self.assertIsNone(measures.comeback(self.seen(self.SHARES[:20], 0))["found_again"], "it has not come back")
        self.assertEqual(measures.comeback(self.seen([0.2] * 30, 0))["gone_frames"], 0)


class Health(unittest.TestCase):
    def test_reports_count_from_the_event(self):
        states = ["tracked"] * 13 + ["degraded"] + ["tracked"] * 9
        frames = [frame(i, 0, 1, health=s) for i, s in enumerate(states)]
        self.assertEqual(measures.report_delay(frames, 10), 3)
        self.assertEqual(measures.report_delay(frames, 8), 5)
        self.assertIsNone(measures.report_delay(frames, 7))

    def test_only_tracked_poses_count_as_off(self):
        frames = [frame(0, 0, 1, error=0.2), frame(1, 0, 1, error=0.2, health="lost"), frame(2, 0, 1, error=None)]
        self.assertEqual(measures.off_while_tracked(frames, "health", "camera_error_m"), 1)

    def test_slow_frames_are_those_between_the_speeds(self):
        frames = [frame(i, 0, 1, speed=s) for i, s in enumerate((0.0, 0.01, 0.02, 0.05, 0.06, None))]
        self.assertEqual([f["object_speed_m_per_s"] for f in measures.between_speeds(frames, 0.01, 0.05)], [0.02, 0.05])


class Files(unittest.TestCase):
    def test_numbers_and_frames_are_joined_by_time(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "evaluation.json").write_text(json.dumps(
                {"camera": {"ate_first_cm": {"rmse": 1.25}, "nees": {"pose": {"mean": 1.5}},
                            "rpe_cm_per_s": {"count": 0, "rmse": 0.0}}, "object": None}))
            (folder / "sequence.json").write_text('{"frames": 2, "camera_path_m": 2.5}')
            (folder / "frames.csv").write_text("utime,health,object_health,segment_ms,fuse_ms\n1000033333,lost,lost,,\n"
                                               "1000066667,tracked,tracked,4.0,3.0\n")
            (folder / "each_frame.csv").write_text(
                "timestamp,camera_error_m,object_error_m,iou\n1000.066667,0.3,0.01,\n1000.033333,,0.2,0.5\n")
            finished = measures.Finished(folder)
            row = measures.common(finished)
            self.assertEqual((row["camera_ate_first_cm"], row["camera_nees"], row["camera_rpe_cm_per_s"],
                              row["object_ate_first_cm"]), (1.25, 1.5, None, None))
            self.assertEqual((row["frame_ms_median"], row["off_while_tracked"], row["object_off_while_tracked"],
                              row["camera_path_m"]), (7.0, 1, 0, 2.5))
            self.assertEqual([f["health"] for f in finished.each_frame()], ["tracked", "lost"])


if __name__ == "__main__":
    unittest.main()
