# SPDX-License-Identifier: BSD-3-Clause
"""What the experiments ask for."""
import argparse
import pathlib
import tempfile
import unittest

from rf_experiments import cli
from rf_experiments.experiments import ALL
from rf_experiments.plan import Plan
from rf_experiments.runs import Run, Sequence

RECORDINGS = ("tum_fr1_rpy", "tum_fr3_walking_halfsphere")


class Cases(unittest.TestCase):
    def test_rows_differ_and_so_do_their_runs(self):
        for name, experiment in ALL.items():
            cases = experiment.cases(Plan(recordings=RECORDINGS, known_scenes=("leave", "behind")))
            self.assertGreater(len(cases), 1, name)
            self.assertEqual(len({c.tags for c in cases}), len(cases), name)
            self.assertEqual(len({c.run for c in cases}), len(cases), name)

    def test_ours_runs_on_more_seeds_than_the_baselines(self):
        cases = ALL["camera"].cases(Plan(seeds=(1, 2, 3), baseline_seeds=(7,)))
        seeds = {m: {c.run.sequence.seed for c in cases if c.run.mode == m} for m in ("rigidfusion", "vo")}
        self.assertEqual(seeds, {"rigidfusion": {1, 2, 3}, "vo": {7}})
        self.assertEqual(len({c.run.mode for c in cases}), 5)

    def test_experiments_share_runs(self):
        plan = Plan()
        camera = {c.run for c in ALL["camera"].cases(plan)}
        self.assertLessEqual({c.run for c in ALL["models"].cases(plan)}, camera)

    def test_quick_is_short(self):
        plan = Plan(seeds=(1,), baseline_seeds=(1,), quick=True, recordings=RECORDINGS)
        runs = {c.run for experiment in ALL.values() for c in experiment.cases(plan)}
        self.assertTrue(all(0 < r.sequence.frames <= 60 for r in runs))
        self.assertLessEqual(len(runs), 18)
        self.assertLessEqual(len({r.sequence for r in runs}), 6)

    def test_scenes_can_be_left_out(self):
        cases = ALL["masks"].cases(Plan(scenes=("orbit", "size065")))
        self.assertEqual({c.run.sequence.scene for c in cases}, {"orbit", "size065"})

    def test_runs_are_chosen_by_their_labels(self):
        cases = ALL["drift"].cases(Plan())
        chosen = cli.matching(cases, cli.pattern("object prior none, drift 0.34"))
        self.assertEqual({(dict(c.tags)["object_prior"], dict(c.tags)["drift_cm_per_s"]) for c in chosen}, {("none", 34)})
        self.assertEqual(cli.matching(cases, None), cases)
        with self.assertRaisesRegex(argparse.ArgumentTypeError, "missing"):
            cli.pattern("(")

    def test_settings_that_rf_run_does_not_know_are_left_out(self):
        uses = [{dict(c.tags)["object_prior"] for c in ALL["drift"].cases(Plan(knows=lambda s: answer))}
                for answer in (True, False)]
        self.assertEqual(uses[0] - uses[1], {"at gate and start"})

    def test_ablations_are_of_our_mode(self):
        cases = cli.with_settings(ALL["camera"].cases(Plan()), ["a.b=1"])
        self.assertEqual({c.run.mode for c in cases if c.run.settings}, {"rigidfusion"})


class Words(unittest.TestCase):
    def test_seeds_are_lists_and_ranges(self):
        self.assertEqual(cli.numbers("1,3-5,3"), (1, 3, 4, 5))
        for wrong in ("", "a", "3-1"):
            with self.assertRaises(ValueError):
                cli.numbers(wrong)

    def test_names_tell_cuts_and_noise_apart(self):
        names = [Sequence("a", 1).name, Sequence("a", 1, 5, 9).name, Sequence("a", 1, noise=0.5).name]
        self.assertEqual(names, ["a-1", "a-1-5-9", "a-1-noise0.5"])
        self.assertIn("object prior none", Run(Sequence("a"), object_prior="none").label)

    def test_missing_programs_are_named(self):
        with tempfile.TemporaryDirectory() as folder:
            _, options = cli.parse(["--bin", folder], pathlib.Path("/"), None)
            self.assertIn("rf-run: not there", "\n".join(cli.missing_things(options)))


if __name__ == "__main__":
    unittest.main()
