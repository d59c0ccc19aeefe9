# SPDX-License-Identifier: BSD-3-Clause
"""Programs that are started, and stopped when this one is. They get a session of their own: a signal from
the terminal must not end rf-run early with a result that looks whole."""
import os
import signal
import subprocess
import threading

POLL_S = 0.1
PATIENCE_S = 5.0
TAIL = 2000  # characters of a failed program's messages


class Stopped(Exception):
    """Work was asked to stop."""


class ProgramFailed(Exception):
    """A program ended with another exit code than 0; the text says which and what it wrote."""


class Children:
    """Calls programs from any thread until stop() is called."""

    def __init__(self):
        self.stopping = threading.Event()

    def stop(self):
        self.stopping.set()

    def call(self, log, *command):
        """Standard output of a program; its messages go to the file `log`."""
        if self.stopping.is_set():
            raise Stopped
        words = [str(c) for c in command]
        out = log.with_suffix(".out")
        with open(out, "wb") as stdout, open(log, "wb") as stderr:
            process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=stdout, stderr=stderr,
                                       start_new_session=True)
            code = self.wait(process)
        if code != 0:
            tail = log.read_text(errors="replace")[-TAIL:]
            raise ProgramFailed(f"{' '.join(words)}: exit code {code}\n{tail}")
        return out.read_text()

    def wait(self, process):
        while True:
            try:
                return process.wait(POLL_S)
            except subprocess.TimeoutExpired:
                if self.stopping.is_set():
                    self.end(process)
                    raise Stopped from None

    @staticmethod
    def end(process):
        """With what it started: its session is its own."""
        os.killpg(process.pid, signal.SIGTERM)
        try:
            process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
