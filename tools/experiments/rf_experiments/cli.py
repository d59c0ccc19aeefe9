# SPDX-License-Identifier: BSD-3-Clause
"""rf-experiments: tables and figures of the method, its modes and its priors on simulated and real sequences.

Renders with rf-simulate, runs rf-run, measures with rf-evaluate. Every finished run is kept in the work folder
under a digest of the programs, the sequence and the options: a call that was interrupted goes on where it was, and
nothing is computed twice. Results: <experiment>.csv (a row a run), .md (medians and quartiles), .png, summary.md.

Exit codes: 0 done, 1 a run failed (the others stand in the tables), 2 bad usage, 3 something that it needs is
missing, 130 interrupted.
"""
import argparse
import contextlib
import dataclasses
import pathlib
import re
import shlex
import signal
import subprocess
import sys
import tempfile

from . import measures, report, summary
from .cache import Cache
from .children import Children
from .execute import Executor
from .experiments import ALL
from .plan import OURS, Plan
from .sequences import Sequences

EXIT_FAILED, EXIT_USAGE, EXIT_MISSING, EXIT_INTERRUPTED = 1, 2, 3, 130
RF_RUN_BAD_CONFIGURATION = 2


def numbers(text):
    """`1,2,5-8` as a tuple."""
    result = []
    for word in text.split(","):
        first, _, last = word.partition("-")
        result += range(int(first), int(last or first) + 1)
    if not result or min(result) < 0:
        raise ValueError(text)
    return tuple(dict.fromkeys(result))


def words(text):
    return tuple(w for w in text.split(",") if w)


def positive(text):
    value = int(text)
    if value < 1:
        raise ValueError(text)
    return value


def pattern(text):
    try:
        return re.compile(text)
    except re.error as error:
        raise argparse.ArgumentTypeError(f"{text}: {error}") from error


def parse(arguments, bin_folder, recordings):
    parser = argparse.ArgumentParser(prog="rf-experiments", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--list", action="store_true", help="print the experiments and leave")
    parser.add_argument("--only", type=words, default=(), metavar="NAME,...", help="these experiments; default: all")
    parser.add_argument("--seeds", type=numbers, default=(1, 2, 3, 4, 5), help="of our mode (default: 1-5)")
    parser.add_argument("--baseline-seeds", type=numbers, default=(1, 2), help="of the other modes (default: 1,2)")
    parser.add_argument("--scenes", type=words, default=(), metavar="NAME,...", help="leave out all other scenes")
    parser.add_argument("--runs", type=pattern, metavar="REGEX",
                        help="leave out the runs whose label, as --dry-run prints it, has no match")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings",
                        help="of rf-run, in every run of our mode: for ablations, each into its own --output")
    parser.add_argument("--quick", action="store_true", help="cuts of 60 frames, seed 1, few runs of each experiment")
    parser.add_argument("--jobs", type=positive, default=1, metavar="N", help="programs at a time (default: 1)")
    parser.add_argument("--threads", type=positive, default=1, metavar="N", help="threads of each (default: 1)")
    parser.add_argument("--output", type=pathlib.Path, default=pathlib.Path("results/experiments"),
                        help="folder for tables and figures (default: results/experiments)")
    parser.add_argument("--work", type=pathlib.Path, help="folder of the cache (default: OUTPUT/work)")
    parser.add_argument("--sequences", type=pathlib.Path,
                        help="folder of the rendered sequences (default: WORK/sequences); whole ones are used")
    parser.add_argument("--keep", action="store_true", help="keep the rendered sequences after their last run")
    parser.add_argument("--bin", type=pathlib.Path, default=bin_folder, help="folder of the programs")
    parser.add_argument("--recordings", type=pathlib.Path, action="append", metavar="DIR",
                        help="folder of folders with real recordings, repeatable (default: those of the project)")
    parser.add_argument("--dry-run", action="store_true", help="print what would be run and leave")
    options = parser.parse_args(arguments)
    options.recordings = options.recordings or [recordings] * bool(recordings)
    options.work = options.work or options.output / "work"
    options.sequences = options.sequences or options.work / "sequences"
    if options.quick:
        options.seeds = options.baseline_seeds = (1,)
    return parser, options


def knows(bin_folder):
    """Whether rf-run has a setting: it refuses unknown ones before it looks into its input, here an empty folder."""
    answers = {}

    def ask(setting):
        if setting not in answers:
            with tempfile.TemporaryDirectory() as empty:
                done = subprocess.run([bin_folder / "rf-run", "--input", empty, "--output", empty, "--set", setting],
                                      capture_output=True, check=False)
            answers[setting] = done.returncode != RF_RUN_BAD_CONFIGURATION
        return answers[setting]
    return ask


def said_by(program, option):
    return subprocess.run([program, option], capture_output=True, text=True, check=False).stdout


def noises(bin_folder):
    """Factors on the sensor's noise: rf-simulate of an earlier version has no such option."""
    return (1.0, 0.5, 2.0) if "--noise" in said_by(bin_folder / "rf-simulate", "--help") else (1.0,)


def scenes(bin_folder):
    """Names of rf-simulate's scenes."""
    return tuple(line.split()[0] for line in said_by(bin_folder / "rf-simulate", "--list").splitlines() if line)


def recordings_in(folders):
    """{name: folder} of the recordings below some folders."""
    return {f.parent.name: f.parent for folder in folders for f in sorted(folder.glob("*/camera.yaml"))}


def with_settings(cases, settings):
    """The cases with more settings in the runs of our mode."""
    if not settings:
        return cases
    return [dataclasses.replace(c, run=dataclasses.replace(c.run, settings=c.run.settings + tuple(settings)))
            if c.run.mode == OURS else c for c in cases]


def matching(cases, expression):
    """The cases whose runs' labels have a match; all without an expression."""
    return [c for c in cases if expression is None or expression.search(c.run.label)]


def rows_of(experiment, cases, cache):
    """A row for each case whose run is there, with the files it came from under `finished`."""
    rows = []
    for case in cases:
        entry = cache.load(case.run)
        if entry is None:
            continue
        finished = measures.Finished(entry)
        row = {**dict(case.tags), **measures.common(finished)}
        row.update(experiment.measure(finished, row))
        rows.append({**row, "run": entry.name, "finished": finished})
    return rows


def write_report(name, experiment, cases, cache, folder):
    rows = rows_of(experiment, cases, cache)
    out = report.Report(folder, name, experiment.TITLE)
    if len(rows) < len(cases):
        out.text(f"{len(cases) - len(rows)} of {len(cases)} runs failed and are left out.")
    if rows:
        experiment.report(rows, out)
    else:
        out.text("Nothing was run: its scenes or recordings are not there, or were left out.")
    out.write([{k: v for k, v in row.items() if k != "finished"} for row in rows])


@contextlib.contextmanager
def stopping_on_signals(children):
    """SIGINT and SIGTERM ask for a stop; an exception out of Thread.join would lose track of the thread."""
    kinds = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(kind, lambda *_: children.stop()) for kind in kinds]
    try:
        yield
    finally:
        for kind, handler in zip(kinds, before):
            signal.signal(kind, handler)


def run(options, plan, chosen):
    cases = {name: matching(with_settings(experiment.cases(plan), options.settings), options.runs)
             for name, experiment in chosen.items()}
    wanted = [case.run for group in cases.values() for case in group]
    if options.dry_run:
        print("\n".join(dict.fromkeys(r.label for r in wanted)))
        return 0
    options.output.mkdir(parents=True, exist_ok=True)
    recordings = recordings_in(options.recordings)
    cache = Cache(options.work / "cache", options.bin, recordings)
    children = Children()
    sequences = Sequences(options.sequences, options.bin, recordings, children,
                          cache.programs["rf-simulate"], options.threads)
    executor = Executor(cache, sequences, children, options.bin, options.threads, options.keep)
    with stopping_on_signals(children):
        whole = executor.execute(wanted, options.jobs)
    if children.stopping.is_set():
        return EXIT_INTERRUPTED
    for name, experiment in chosen.items():
        write_report(name, experiment, cases[name], cache, options.output)
    notes = ["quick: cuts of 60 frames, which say that the tool works, not how well the method does"] * options.quick
    notes += [f"failed: {label}" for label, _ in executor.failures]
    summary.write(options.output, list(ALL), command_line(), notes)
    for entry in dict.fromkeys(cache.damaged):
        print(f"rf-experiments: entry {entry} was damaged and was made anew", file=sys.stderr)
    print(f"rf-experiments: {executor.made} runs made; {options.output / 'summary.md'}", file=sys.stderr)
    return 0 if whole else EXIT_FAILED


def command_line():
    return shlex.join(["rf-experiments", *sys.argv[1:]])


def missing_things(options):
    missing = [f"{options.bin / p}: not there (--bin)" for p in ("rf-simulate", "rf-run", "rf-evaluate")
               if not (options.bin / p).exists()]
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        missing.append("matplotlib: not there; on Debian: apt-get install python3-matplotlib")
    return missing


def main(arguments, bin_folder, recordings):
    parser, options = parse(arguments, bin_folder, recordings)
    if options.list:
        print("\n".join(f"{name:<8} {experiment.TITLE}" for name, experiment in ALL.items()))
        return 0
    missing = missing_things(options)
    if missing:
        print("\n".join(f"rf-experiments: {m}" for m in missing), file=sys.stderr)
        return EXIT_MISSING
    unknown = [n for n in options.only if n not in ALL]
    if unknown:
        parser.error(f"--only {','.join(unknown)}: there are {', '.join(ALL)}")
    ask = knows(options.bin)
    unusable = [s for s in options.settings if not ask(s)]
    if unusable:
        parser.error(f"--set {unusable[0]}: rf-run refuses it")
    plan = Plan(options.seeds, options.baseline_seeds, options.scenes, options.quick, ask,
                tuple(recordings_in(options.recordings)), scenes(options.bin), noises(options.bin))
    try:
        return run(options, plan, {n: e for n, e in ALL.items() if not options.only or n in options.only})
    except KeyboardInterrupt:
        return EXIT_INTERRUPTED
