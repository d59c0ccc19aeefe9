# SPDX-License-Identifier: BSD-3-Clause
"""Keys, entries, damage, and stopping; with programs that are small scripts."""
import dataclasses
import json
import os
import pathlib
import signal
import subprocess
import tempfile
import threading
import time
import unittest

import rf_experiments
from rf_experiments import aside
from rf_experiments.cache import Cache
from rf_experiments.children import Children, ProgramFailed, Stopped
from rf_experiments.execute import Executor
from rf_experiments.runs import Run, Sequence
from rf_experiments.sequences import Sequences

TOOL = pathlib.Path(rf_experiments.__file__).parent.parent / "rf-experiments"
PROGRAMS = {
    # writes three frames and counts its calls
    "rf-simulate": """
while [ $# -gt 0 ]; do [ "$1" = --output ] && out=$2; shift; done
echo called >>"$(dirname "$0")/rendered"
mkdir -p "$out"; printf '1.0 a\\n2.0 b\\n3.0 c\\n' | tee "$out/rgb.txt" >"$out/depth.txt"
""",
    "rf-run": """
while [ $# -gt 0 ]; do [ "$1" = --output ] && out=$2; [ "$1" = --mode ] && mode=$2; shift; done
mkdir -p "$out"; printf 'utime\\n1\\n2\\n3\\n' >"$out/frames.csv"
[ "$mode" = short ] && echo utime >"$out/frames.csv"
[ "$mode" = fails ] && { echo no such mode >&2; exit 2; }
[ "$mode" = hangs ] && sleep 60
exit 0
""",
    "rf-evaluate": """
while [ $# -gt 0 ]; do [ "$1" = --per-frame ] && echo timestamp >"$2"; shift; done
echo '{}'
""",
}


class Workshop(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.bin = self.folder / "bin"
        self.bin.mkdir()
        for name, body in PROGRAMS.items():
            (self.bin / name).write_text("#!/bin/sh\n" + body)
            (self.bin / name).chmod(0o755)

    def tool(self, keep=False):
        cache = Cache(self.folder / "cache", self.bin, {})
        children = Children()
        sequences = Sequences(self.folder / "sequences", self.bin, {}, children, cache.programs["rf-simulate"], 1)
        executor = Executor(cache, sequences, children, self.bin, 1, keep)
        executor.say = lambda text: None
        return executor

    def renders(self):
        file = self.bin / "rendered"
        return len(file.read_text().splitlines()) if file.exists() else 0

    def test_runs_are_made_once_and_share_a_rendering(self):
        wanted = [Run(Sequence("a"), mode="x"), Run(Sequence("a"), mode="y"), Run(Sequence("a"), mode="x")]
        first = self.tool()
        self.assertTrue(first.execute(wanted, 2))
        self.assertEqual((first.made, self.renders()), (2, 1))
        self.assertEqual(os.listdir(self.folder / "sequences"), [], "removed after the last run")
        again = self.tool()
        self.assertTrue(again.execute(wanted, 1))
        self.assertEqual((again.made, self.renders()), (0, 1))

    def test_damage_is_seen_and_made_good(self):
        run = Run(Sequence("a"))
        self.tool().execute([run], 1)
        for damage in (lambda e: (e / "evaluation.json").write_text("{ "), lambda e: (e / "entry.json").unlink(),
                       lambda e: (e / "frames.csv").unlink(), lambda e: (e / "entry.json").write_text("[]")):
            tool = self.tool()
            damage(tool.cache.folder / tool.cache.key(run))
            self.assertTrue(tool.execute([run], 1))
            self.assertEqual((tool.made, len(tool.cache.damaged)), (1, 1))
            self.assertIsNotNone(tool.cache.load(run))

    def test_the_key_knows_programs_and_options(self):
        run = Run(Sequence("a"))
        key = self.tool().cache.key(run)
        others = [dataclasses.replace(run, settings=("a.b=1",)), dataclasses.replace(run, drift=(1.0, 2.0)),
                  Run(Sequence("a", 2)), Run(Sequence("a", 1, 0, 9)), dataclasses.replace(run, event="teleport")]
        self.assertEqual(len({key, *(self.tool().cache.key(r) for r in others)}), 6)
        (self.bin / "rf-run").write_text("#!/bin/sh\nexit 0\n")
        self.assertNotEqual(self.tool().cache.key(run), key)

    def test_failures_leave_no_entry_and_do_not_end_the_others(self):
        wanted = [Run(Sequence("a"), mode=m) for m in ("fails", "short", "good")]
        tool = self.tool()
        self.assertFalse(tool.execute(wanted, 1))
        self.assertEqual(len(tool.failures), 2)
        self.assertIn("no such mode", tool.failures[0][1])
        self.assertEqual([tool.cache.load(r) is not None for r in wanted], [False, False, True])

    def test_given_sequences_are_used_and_stay(self):
        given = self.folder / "sequences/a-1"
        given.mkdir(parents=True)
        for name in ("rgb.txt", "depth.txt"):
            (given / name).write_text("1.0 a\n2.0 b\n3.0 c\n")
        (given / "done").touch()
        self.assertTrue(self.tool().execute([Run(Sequence("a"))], 1))
        self.assertEqual(self.renders(), 0)
        self.assertTrue((given / "depth.txt").exists())

    def test_folders_that_are_not_whole_are_not_touched(self):
        foreign = self.folder / "sequences/a-1"
        foreign.mkdir(parents=True)
        (foreign / "depth.txt").touch()
        tool = self.tool()
        self.assertFalse(tool.execute([Run(Sequence("a"))], 1))
        self.assertIn("without `done`", tool.failures[0][1])
        self.assertTrue((foreign / "depth.txt").exists())

    def test_sequences_of_another_simulator_are_rendered_anew(self):
        tool = self.tool(keep=True)
        tool.execute([Run(Sequence("a"))], 1)
        done = self.folder / "sequences/a-1/done"
        self.assertEqual(json.loads(done.read_text()), {"rf-simulate": tool.cache.programs["rf-simulate"]})
        with open(self.bin / "rf-simulate", "a") as file:
            file.write("# another\n")
        self.assertTrue(self.tool(keep=True).execute([Run(Sequence("a"))], 1))
        self.assertEqual(self.renders(), 2)

    def test_a_stop_ends_programs_and_leaves_nothing_half_done(self):
        tool = self.tool()
        wanted = [Run(Sequence("a"), mode="good"), Run(Sequence("b"), mode="hangs"), Run(Sequence("c"))]
        timer = threading.Timer(1.5, tool.children.stop)
        timer.start()
        begin = time.monotonic()
        self.assertFalse(tool.execute(wanted, 1))
        self.assertLess(time.monotonic() - begin, 20)
        self.assertEqual([tool.cache.load(r) is not None for r in wanted], [True, False, False])
        self.assertEqual([n for n in os.listdir(tool.cache.folder) if n.startswith(".")], [])

    def test_signals_end_the_tool_and_its_programs(self):
        (self.bin / "rf-run").write_text('#!/bin/sh\necho $$ >"$(dirname "$0")/pid"\nexec sleep 60\n')
        for sent in (signal.SIGINT, signal.SIGTERM):
            tool = subprocess.Popen([TOOL, "--bin", self.bin, "--output", self.folder / "out", "--only", "held",
                                     "--seeds", "1"], stderr=subprocess.DEVNULL)
            pid = self.bin / "pid"
            while not (pid.exists() and pid.read_text().strip()):
                time.sleep(0.05)
            tool.send_signal(sent)
            self.assertEqual(tool.wait(30), 130)
            self.assertFalse(pathlib.Path("/proc", pid.read_text().strip()).exists())
            self.assertEqual(list((self.folder / "out" / "work" / "cache").iterdir()), [])
            pid.unlink()

    def test_what_killed_calls_left_is_removed(self):
        for name in ("cache", "sequences"):
            folder = self.folder / name
            folder.mkdir(exist_ok=True)
            mine = aside.path(folder, "a-1")
            mine.mkdir()
            (folder / f"{aside.PREFIX}a-1-999999999").mkdir()
            (folder / f"{aside.PREFIX}a-1-999999999.log").touch()
            (folder / ".tmp-999999999").mkdir()
            self.tool()
            self.assertEqual(set(os.listdir(folder)), {mine.name, ".tmp-999999999"})

    def test_failed_programs_say_why(self):
        with self.assertRaisesRegex(ProgramFailed, "exit code 2\nno such mode"):
            Children().call(self.folder / "log", self.bin / "rf-run", "--mode", "fails", "--output", self.folder / "x")
        stopped = Children()
        stopped.stop()
        with self.assertRaises(Stopped):
            stopped.call(self.folder / "log", "true")


if __name__ == "__main__":
    unittest.main()
