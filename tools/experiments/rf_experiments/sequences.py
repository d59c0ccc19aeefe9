# SPDX-License-Identifier: BSD-3-Clause
"""Rendered sequences on disk: made when first needed, shared by all runs of them, removed after the last.
A folder counts as whole when it holds `done`: the digest of the rf-simulate that made it, or nothing at all
for one that somebody else put there, which is used as it is and never removed."""
import json
import os
import shutil
import threading


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
        aside = self.folder / f".{sequence.name}-{os.getpid()}"
        shutil.rmtree(aside, ignore_errors=True)
        log = self.folder / f".{sequence.name}-{os.getpid()}.log"
        try:
            noise = ["--noise", sequence.noise] if sequence.noise != 1 else []
            self.children.call(log, self.bin / "rf-simulate", "--scene", sequence.scene, "--seed", sequence.seed,
                               "--start", sequence.start, "--frames", sequence.frames, *noise,
                               "--threads", self.threads, "--output", aside)
            (aside / "done").write_text(json.dumps({"rf-simulate": self.digest}) + "\n")
            shutil.rmtree(self.folder / sequence.name, ignore_errors=True)
            aside.rename(self.folder / sequence.name)
        finally:
            shutil.rmtree(aside, ignore_errors=True)
            for file in (log, log.with_suffix(".out")):
                file.unlink(missing_ok=True)

    def remove(self, sequence):
        """Only what this tool rendered."""
        done = self.folder / sequence.name / "done"
        if not sequence.recorded and done.exists() and self.maker(done):
            shutil.rmtree(self.folder / sequence.name)
