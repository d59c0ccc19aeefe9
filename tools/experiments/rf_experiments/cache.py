# SPDX-License-Identifier: BSD-3-Clause
"""Finished runs on disk. The key is a digest of all that decides the result: the programs' bytes, the run's
description, and for derived inputs the code that makes them. An entry carries the digests of its files: one
that was damaged is removed and made anew. Entries appear whole or not at all (written aside, then renamed)."""
import hashlib
import json
import pathlib
import shutil

from . import aside, derive, poses

KEPT = ("evaluation.json", "each_frame.csv", "frames.csv", "camera.txt", "object.txt", "sequence.json")
PROGRAMS = ("rf-simulate", "rf-run", "rf-evaluate")
LAYOUT = 1  # raise when the kept files change


def digest_of(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def digest_of_code(*modules):
    return hashlib.sha256(b"".join(pathlib.Path(m.__file__).read_bytes() for m in modules)).hexdigest()


def digest_of_recording(folder):
    """Of the lists and poses; images are told apart by name and size."""
    total = hashlib.sha256()
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            content = path.read_bytes() if path.suffix in (".txt", ".yaml") else str(path.stat().st_size).encode()
            total.update(str(path.relative_to(folder)).encode() + b"\0" + content)
    return total.hexdigest()


class Cache:
    """Entries below one folder, for one set of programs."""

    def __init__(self, folder, bin_folder, recordings):
        self.folder = folder
        self.programs = {name: digest_of(bin_folder / name) for name in PROGRAMS}
        self.recordings = recordings  # {name: folder}
        self.damaged = []  # keys of entries that had to be removed
        self.recording_digests = {}
        folder.mkdir(parents=True, exist_ok=True)
        aside.remove_left(folder)

    def key(self, run):
        parts = {"run": run.description(), "layout": LAYOUT}
        if run.sequence.recorded:
            parts["recording"] = self.recording(run.sequence.scene)
        used = [p for p in PROGRAMS if not (run.sequence.recorded and p == "rf-simulate")]
        parts["programs"] = {p: self.programs[p] for p in used}
        if run.derived:
            parts["derived"] = digest_of_code(derive, poses)
        return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()[:24]

    def recording(self, name):
        if name not in self.recording_digests:
            self.recording_digests[name] = digest_of_recording(self.recordings[name])
        return self.recording_digests[name]

    def load(self, run):
        """Folder of the run's entry; None when there is none or it was damaged."""
        entry = self.folder / self.key(run)
        if not entry.exists():
            return None
        if self.is_whole(entry):
            return entry
        self.damaged.append(entry.name)
        shutil.rmtree(entry)
        return None

    @staticmethod
    def is_whole(entry):
        try:
            files = json.loads((entry / "entry.json").read_text())["files"]
            return "evaluation.json" in files and all(digest_of(entry / n) == d for n, d in files.items())
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return False

    def scratch(self, run):
        """An empty folder beside the entries to make one in."""
        folder = aside.path(self.folder, self.key(run))
        folder.mkdir()
        return folder

    def store(self, run, result):
        """Moves what is kept of a result folder into the run's entry."""
        key = self.key(run)
        made = aside.path(self.folder, f"{key}-entry")
        made.mkdir()
        kept = [name for name in KEPT if (result / name).exists()]
        for name in kept:
            shutil.copyfile(result / name, made / name)
        entry = {"label": run.label, "run": run.description(), "programs": self.programs,
                 "files": {name: digest_of(made / name) for name in kept}}
        (made / "entry.json").write_text(json.dumps(entry, indent=1) + "\n")
        shutil.rmtree(self.folder / key, ignore_errors=True)
        made.rename(self.folder / key)
        return self.folder / key
