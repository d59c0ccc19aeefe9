# SPDX-License-Identifier: BSD-3-Clause
"""Rendered sequences on disk: made when first needed, shared by all runs of them, removed after the last.
A folder counts as whole when it holds `done`: the digest of the rf-simulate that made it, or nothing at all
for one that somebody else put there, which is used as it is and never removed."""
import json
import shutil
import threading

from . import aside


class Sequences:
    def __init__(self, folder, bin_folder, recordings, children, simulator_digest, threads):
        self.folder = folder
        self.bin = bin_folder
        self.recordings = recordings  # {name: folder}
        self.children = children
        self.digest = simulator_digest
        self.threads = threads
        self.guard = threading.Lock()
        self.locks = {}
        folder.mkdir(parents=True, exist_ok=True)
        aside.remove_left(folder)

    def lock(self, sequence):
        with self.guard:
            return self.locks.setdefault(sequence, threading.Lock())

    def is_ready(self, sequence):
        if sequence.recorded:
            return True
        done = self.folder / sequence.name / "done"
        return done.exists() and self.maker(done) in ("", self.digest)

    @staticmethod
    def maker(done):
        text = done.read_text()
        return json.loads(text)["rf-simulate"] if text.strip() else ""

    def get(self, sequence, on_render):
        """The folder, rendered when it is not there. `on_render` is called before that."""
        if sequence.recorded:
            return self.recordings[sequence.scene]
        with self.lock(sequence):
            if not self.is_ready(sequence):
                on_render()
                self.render(sequence)
            return self.folder / sequence.name

    def render(self, sequence):
        folder = self.folder / sequence.name
        if folder.exists() and not (folder / "done").exists():
            raise ValueError(f"{folder}: is there without `done`: not whole, and not ours to remove")
        made = aside.path(self.folder, sequence.name.replace(".", "_"))
        log = made.with_suffix(".log")
        try:
            noise = ["--noise", sequence.noise] if sequence.noise != 1 else []
            self.children.call(log, self.bin / "rf-simulate", "--scene", sequence.scene, "--seed", sequence.seed,
                               "--start", sequence.start, "--frames", sequence.frames, *noise,
                               "--threads", self.threads, "--output", made)
            (made / "done").write_text(json.dumps({"rf-simulate": self.digest}) + "\n")
            shutil.rmtree(folder, ignore_errors=True)
            made.rename(folder)
        finally:
            shutil.rmtree(made, ignore_errors=True)
            for file in (log, log.with_suffix(".out")):
                file.unlink(missing_ok=True)

    def remove(self, sequence):
        """Only what this tool rendered."""
        done = self.folder / sequence.name / "done"
        if not sequence.recorded and done.exists() and self.maker(done):
            shutil.rmtree(self.folder / sequence.name)
