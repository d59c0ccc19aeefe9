# SPDX-License-Identifier: BSD-3-Clause
"""Quantiles, ratios, pooled masks, CSV and Markdown, and the lines of the summary."""
import pathlib
import tempfile
import unittest

from rf_experiments import stats, summary, tables
from rf_experiments.experiments import drift, priors, real, size


class Numbers(unittest.TestCase):
    def test_quantiles_are_linear_between_order_statistics(self):
        self.assertEqual(stats.median([3, 1, 2]), 2)
        self.assertEqual(stats.quantile([1, 2, 3, 4], 0.25), 1.75)
        self.assertEqual(stats.quantile([0, 10], 0.95), 9.5)
        self.assertEqual(stats.quantile([7], 0.95), 7)
        self.assertIsNone(stats.median([None, float("nan")]))

    def test_ratios_have_a_floor(self):
        self.assertEqual(stats.floored_ratio(0.1, 0.3), 1.0)
        self.assertEqual(stats.floored_ratio(2.0, 0.1), 4.0)
        self.assertEqual(stats.floored_ratio(0.1, 2.0), 0.25)
        self.assertIsNone(stats.floored_ratio(None, 1.0))

    def test_masks_are_pooled_over_pixels(self):
        frames = [{"static_right": 80, "static_wrong": 0, "dynamic_right": 20, "dynamic_wrong": 0},
                  {"static_right": 0, "static_wrong": 20, "dynamic_right": 40, "dynamic_wrong": 40},
                  {"static_right": None}]
        found = stats.pooled(frames)
        self.assertEqual((found["iou"], found["static_accuracy"], found["dynamic_accuracy"], found["frames"]),
                         (60 / 120, 80 / 100, 60 / 100, 2))
        self.assertIsNone(stats.pooled([])["iou"])


class Tables(unittest.TestCase):
    ROWS = [{"scene": "a", "x": 1.0, "ok": True}, {"scene": "a", "x": 3.0, "ok": False},
            {"scene": "b", "x": 5.0, "ok": True}, {"scene": "b", "x": None, "late": 7}]

    def test_csv_comes_back(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "t.csv")
            tables.write_csv(file, self.ROWS)
            back = tables.read_csv(file)
        self.assertEqual(back[1], {"scene": "a", "x": 3.0, "ok": False, "late": None})
        self.assertEqual(back[3], {"scene": "b", "x": None, "ok": None, "late": 7})

    def test_groups_have_medians_quartiles_and_counts(self):
        text = tables.table(self.ROWS, ("scene",), [("x", "x", 1), ("ok", tables.per_cent("ok"))])
        self.assertEqual(text.splitlines()[2:], ["| a | 2 | 2.0 [1.5, 2.5] | 50 % |", "| b | 2 | 5.0 | 100 % |"])

    def test_nothing_is_a_dash(self):
        self.assertEqual(tables.spread([None], 2), "-")


class Conclusions(unittest.TestCase):
    def test_largest_size_ends_at_the_first_failure(self):
        ate = {0.3: 1, 0.5: 2, 0.7: 6, 0.8: 1}
        rows = [{"method": "rigidfusion", "size": s, "camera_ate_first_cm": a} for s, a in ate.items()]
        self.assertEqual(size.largest_tracked(rows), 0.5)
        self.assertIsNone(size.largest_tracked(rows[2:]))

    def test_tolerated_drift_needs_every_scene(self):
        rows = [{"scene": s, "object_prior": "none", "drift_cm_per_s": d, "camera_rpe_cm_per_s": r}
                for s, d, r in (("a", 0, 1), ("a", 6, 2), ("a", 12, 2), ("b", 0, 1), ("b", 6, 1), ("b", 12, 9))]
        self.assertEqual(drift.tolerated(rows, "none"), 6)

    def test_poses_off_while_tracked_are_counted_in_every_experiment(self):
        def row(run, method="rigidfusion", camera=0, body=0):
            return {"run": run, "method": method, "off_while_tracked": camera, "object_off_while_tracked": body}

        known = {"camera": [row("a", camera=3), row("b", body=None), row("c", "vo", camera=99)],
                 "models": [{k: v for k, v in row("a", camera=3).items() if k != "method"}, row("d", body=7)]}
        lines = [line.split(" | ") for line in summary.off_table(known).splitlines()[2:]]
        self.assertEqual([[cell.strip("| ") for cell in line] for line in lines],
                         [["camera", "2", "1", "3", "0", "0"], ["models", "2", "1", "3", "1", "7"],
                          ["all", "3", "1", "3", "1", "7"]])

    def test_rotation_drifts_in_proportion_up_to_its_cap(self):
        self.assertAlmostEqual(drift.rotation(6), 0.4)
        self.assertAlmostEqual(drift.rotation(3), 0.2)
        self.assertAlmostEqual(drift.rotation(34), 1.2)

    def test_prior_ratios_use_the_reference_of_the_same_sequence(self):
        rows = [{"scene": "a", "seed": s, "case": c, "camera_ate_first_cm": a, "camera_rpe_cm_per_s": 1.0,
                 "prior_ate_first_cm": 2.0, "prior_rpe_cm_per_s": 1.0}
                for s, c, a in ((1, "good prior", 1.0), (1, "frozen", 6.0), (1, "no camera prior", 3.0),
                                (2, "frozen", 6.0))]
        priors.add_ratios(rows)
        self.assertEqual([r["ATE_ratio"] for r in rows], [0.5, 2.0, None, None])
        self.assertEqual(priors.worst(rows)["frozen"], (2.0, 2.0))

    def test_the_longest_recording_counts(self):
        rows = [{"recording": n, "frames": f, "x": x} for n, f, x in
                (("tum_a", 45, 1), ("tum_a_150", 150, 2), ("tum_a_150", 150, 3), ("tum_a_200", 200, None))]
        self.assertEqual([r["x"] for r in real.longest(rows, "tum_a", "x")], [2, 3])

    def test_summary_says_reached_missed_and_not_run(self):
        at_most = summary.Figure("x", "", 1.5, "camera", summary.middle("x"))
        at_least = summary.Figure("x", "", 1.5, "camera", summary.middle("x"), at_least=True)
        rows = [{"x": 1.0}, {"x": 1.2}, {"x": None}]
        self.assertEqual(at_most.line(rows)[-2:], ["1.10 (n 2)", "reached"])
        self.assertEqual(at_least.line(rows)[-2:], ["1.10 (n 2)", "missed"])
        self.assertEqual(at_most.line(None)[-2:], ["not run", ""])

    def test_every_figure_reads_a_table_that_lacks_its_column(self):
        row = {"scene": "none", "method": "vo", "case": "frozen", "size": 0.5, "object_prior": "all", "seed": 1,
               "drift_cm_per_s": 0, "onset_found": False, "recording": "none", "frames": 1}
        for figure in summary.figures():
            line = figure.line([row])
            self.assertEqual(len(line), 5, figure.what)
            self.assertIn(line[-1], ("not run", "missed", "reached"), figure.what)


if __name__ == "__main__":
    unittest.main()
