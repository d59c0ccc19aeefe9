# SPDX-License-Identifier: BSD-3-Clause
"""Makes the runs that the cache does not hold, several at a time, a sequence's runs together."""
import collections
import json
import shutil
import sys
import threading
import time

from . import derive, poses, runs
from .children import ProgramFailed, Stopped


class Executor:
    def __init__(self, cache, sequences, children, bin_folder, threads, keep):
        self.cache = cache
        self.sequences = sequences
        self.children = children
        self.bin = bin_folder
        self.threads = threads
        self.keep = keep
        self.failures = []  # (label, text)
        self.made = 0

    def execute(self, wanted, jobs):
        """Makes what is missing of the wanted runs. True when all are there."""
        missing = [r for r in dict.fromkeys(wanted) if self.cache.load(r) is None]
        missing.sort(key=lambda r: r.sequence)
        self.waiting = missing
        self.left = collections.Counter(r.sequence for r in missing)
        self.rendering = set()
        self.total, self.done, self.begin = len(missing), 0, time.monotonic()
        self.change = threading.Condition()
        self.say(f"{len(set(wanted))} runs, {self.total} to be made")
        workers = [threading.Thread(target=self.work) for _ in range(min(jobs, max(1, self.total)))]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        if self.children.stopping.is_set():
            self.say("stopped; finished runs are kept")
        return self.done == self.total and not self.failures

    def work(self):
        while (run := self.next_run()) is not None:
            try:
                self.make(run)
            except Stopped:
                return
            except (ProgramFailed, OSError, ValueError) as problem:
                self.failed(run, problem)
            self.finished(run)

    def next_run(self):
        """The first run whose sequence nobody renders at the moment, else the first."""
        with self.change:
            if not self.waiting or self.children.stopping.is_set():
                return None
            free = [r for r in self.waiting if r.sequence not in self.rendering]
            run = (free or self.waiting)[0]
            self.waiting.remove(run)
            if not self.sequences.is_ready(run.sequence):
                self.rendering.add(run.sequence)
            return run

    def finished(self, run):
        with self.change:
            self.rendering.discard(run.sequence)
            self.left[run.sequence] -= 1
            last = self.left[run.sequence] == 0
            self.done += 1
            self.say(f"{self.done}/{self.total} {run.label}; about {clock(self.remaining())} left")
        if last and not self.keep:
            self.sequences.remove(run.sequence)

    def failed(self, run, problem):
        with self.change:
            self.failures.append((run.label, str(problem)))
            self.say(f"FAILED {run.label}: {problem}")

    def remaining(self):
        """Seconds, if the other runs take as long as those that were made."""
        return (time.monotonic() - self.begin) * (self.total - self.done) / self.done

    def say(self, text):
        print(f"[{clock(time.monotonic() - self.begin)}] {text}", file=sys.stderr, flush=True)

    def make(self, run):
        sequence = self.sequences.get(run.sequence, lambda: self.say(f"rendering {run.sequence.name}"))
        with self.change:
            self.rendering.discard(run.sequence)
        scratch = self.cache.scratch(run)
        try:
            result = self.run_and_measure(run, sequence, scratch)
            if self.children.stopping.is_set():
                raise Stopped
            self.cache.store(run, result)
            self.made += 1
        finally:
            shutil.rmtree(scratch, ignore_errors=True)

    def run_and_measure(self, run, sequence, scratch):
        folder = prepare(run, sequence, scratch)
        result = scratch / "result"
        self.children.call(scratch / "run.log", self.bin / "rf-run", "--input", folder, "--output", result,
                           "--mode", run.mode, "--threads", self.threads, "--write-masks", "--quiet",
                           *prior_options(run, folder, scratch), *setting_options(run))
        check_complete(folder, result)
        text = self.children.call(scratch / "evaluate.log", self.bin / "rf-evaluate", "--sequence", folder,
                                  "--result", result, "--json", "--per-frame", result / "each_frame.csv",
                                  *absent_priors(run))
        (result / "evaluation.json").write_text(text)
        (result / "sequence.json").write_text(json.dumps(facts(run, sequence, folder)) + "\n")
        return result


def clock(seconds):
    seconds = int(seconds)
    return f"{seconds // 3600}:{seconds // 60 % 60:02}:{seconds % 60:02}"


def prepare(run, sequence, scratch):
    """The folder that rf-run reads: the sequence itself, or one derived from it."""
    if run.cut_recording:
        derive.cut(sequence, scratch / "cut", run.sequence.start, run.sequence.frames)
        return scratch / "cut"
    if run.event:
        derive.sequence_with(run.event, sequence, scratch / "sequence")
        return scratch / "sequence"
    return sequence


def prior_file(run, kind, given, true, scratch):
    """The file that an option names; None: the sequence's own, if it has one."""
    if kind == runs.NONE:
        return runs.NONE
    if kind in derive.PRIORS:
        file = scratch / f"{kind}_{given.name}"
        derive.prior(kind, given, file, run.sequence.seed)
        return file
    return true if run.drift and true.exists() else None


def prior_options(run, folder, scratch):
    options = []
    for option, kind, given, true in (
            ("--camera-prior", run.camera_prior, folder / "odometry.txt", folder / "groundtruth.txt"),
            ("--object-prior", run.object_prior, folder / "object_odometry.txt", folder / "object_groundtruth.txt")):
        file = prior_file(run, kind, given, true, scratch)
        options += [option, file] if file else []
    if run.drift:
        options += ["--simulate-drift", ",".join(f"{d:g}" for d in run.drift), "--drift-seed", run.sequence.seed]
    return options


def setting_options(run):
    return [word for setting in run.settings for word in ("--set", setting)]


def absent_priors(run):
    """rf-evaluate would otherwise judge the sequence's own prior, which the run did not have."""
    kinds = (("--camera-prior", run.camera_prior), ("--object-prior", run.object_prior))
    return [word for option, kind in kinds if kind == runs.NONE for word in (option, runs.NONE)]


def check_complete(folder, result):
    """rf-run ends with 0 when it is stopped, too."""
    rows = len((result / "frames.csv").read_text().splitlines()) - 1
    frames = len(derive.image_list(folder / "depth.txt"))
    if rows < frames * 0.9:  # recordings may hold depth images without colour
        raise ValueError(f"rf-run wrote {rows} rows for {frames} frames")


def facts(run, sequence, folder):
    """What tables need of the sequence once it is gone."""
    known = {"frames": len(derive.image_list(folder / "depth.txt"))}
    for name in ("groundtruth.txt", "object_groundtruth.txt"):
        if (folder / name).exists():
            body = "object" if name.startswith("object") else "camera"
            known[f"{body}_path_m"] = poses.path_length(poses.read(folder / name))
    if run.event:
        frames = len(derive.image_list(sequence / "depth.txt"))
        known["event_frame"] = derive.first_touched(run.event, frames)
    return known
