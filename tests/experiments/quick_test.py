# SPDX-License-Identifier: BSD-3-Clause
"""`rf-experiments --quick` as people call it: all outputs are there, a second call computes nothing, a damaged
entry is made anew. Argument: the program."""
import csv
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = sys.argv.pop(1)
NAMES = ("camera", "robot", "size", "drift", "priors", "onset", "masks", "models", "health", "loop", "objects",
         "held", "real")
PNG = b"\x89PNG"


class Quick(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.out = pathlib.Path(temporary.name)

    def call(self, *options):
        done = subprocess.run([PROGRAM, "--quick", "--jobs", "2", "--output", self.out, *options],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stderr

    def rows(self, name):
        with open(self.out / f"{name}.csv", newline="") as file:
            return list(csv.DictReader(file))

    def test_all_is_made_once(self):
        said = self.call()
        self.check_outputs()
        self.check_numbers()
        self.assertEqual(list((self.out / "work/sequences").iterdir()), [], "no rendering is left")
        tables = {n: (self.out / f"{n}.csv").read_bytes() for n in NAMES}
        made = int(said.split(" runs made")[0].split()[-1])
        self.assertGreaterEqual(made, 14)

        said = self.call()
        self.assertIn("0 to be made", said)
        self.assertIn(" 0 runs made", said)

        entry = self.out / "work/cache" / self.rows("held")[0]["run"]
        (entry / "evaluation.json").write_text("{}")
        said = self.call("--only", "held,loop")
        self.assertIn(f"entry {entry.name} was damaged", said)
        self.assertIn(" 1 runs made", said)
        before, after = (list(csv.DictReader(t.decode().splitlines()))[0]
                         for t in (tables["held"], (self.out / "held.csv").read_bytes()))
        del before["frame_ms_median"], after["frame_ms_median"]  # a time, which no two runs share
        self.assertEqual(before, after, "the same bytes came of it")

    def check_outputs(self):
        for name in NAMES:
            self.assertGreaterEqual(len(self.rows(name)), 1, name)
            self.assertIn("|---|", (self.out / f"{name}.md").read_text(), name)
            pictures = list(self.out.glob(f"{name}-*.png"))
            self.assertGreaterEqual(len(pictures), 1, name)
            for picture in pictures:
                self.assertTrue(picture.read_bytes().startswith(PNG), picture)
                self.assertIn(picture.name, (self.out / f"{name}.md").read_text())
        summary = (self.out / "summary.md").read_text()
        self.assertIn("camera ATE sideway, SE3, cm", summary)
        self.assertTrue("reached" in summary and "missed" in summary)
        self.assertIn("| tracked, but more than 10 cm off | runs |", summary)

    def check_numbers(self):
        """Of a cut as short as this only what cannot fail for accuracy's sake."""
        for row in self.rows("camera"):
            self.assertEqual(row["frames"], "60")
            self.assertGreater(float(row["camera_ate_first_cm"]), 0)
        ours = [r for r in self.rows("camera") if r["method"] == "rigidfusion"][0]
        self.assertLess(float(ours["camera_ate_first_cm"]), float(ours["prior_ate_first_cm"]))
        frozen = {r["case"]: r for r in self.rows("priors")}
        self.assertEqual(frozen["no camera prior"]["prior_ate_first_cm"], "")
        self.assertGreater(float(frozen["frozen"]["prior_ate_first_cm"]), float(ours["prior_ate_first_cm"]))
        uses = {r["object_prior"] for r in self.rows("drift")}
        self.assertEqual(uses, {"in all frames", "at gate and start", "none"})
        covered = [r for r in self.rows("health") if r["event"] == "lens covered"][0]
        self.assertEqual(covered["event_frame"], "36")


if __name__ == "__main__":
    unittest.main()
