# SPDX-License-Identifier: BSD-3-Clause
"""What can be run: a sequence, the priors laid over it, an event put into it, and a mode. Values alone:
equal values are the same run, and their text is what the cache's key is made of."""
import dataclasses

PAPER_CAMERA_DRIFT = (0.06, 0.4)  # m/s, rad/s: mean drift of the paper's camera prior
PAPER_OBJECT_DRIFT = (0.015, 0.1)  # the same of its object prior

GIVEN = "given"  # the sequence's own file (drifts as the paper's)
NONE = "none"
FROZEN = "frozen"  # the given one, standing still from its middle on
JUMPING = "jumping"  # the given one with jumps of 10 cm


@dataclasses.dataclass(frozen=True, order=True)
class Sequence:
    """A rendered scene, or a recording; a cut when frames or start are set."""
    scene: str
    seed: int = 1
    start: int = 0
    frames: int = 0  # 0: to the end
    noise: float = 1.0  # factor on the simulated sensor's noise
    recorded: bool = False  # then scene names a folder of the recordings, and seed seeds the drift alone

    @property
    def name(self):
        cut = f"-{self.start}-{self.frames}" if self.start or self.frames else ""
        noise = f"-noise{self.noise:g}" if self.noise != 1 else ""
        return f"{self.scene}-{self.seed}{cut}{noise}"


@dataclasses.dataclass(frozen=True)
class Run:
    """One call of rf-run and the rf-evaluate that follows."""
    sequence: Sequence
    mode: str = "rigidfusion"
    camera_prior: str = GIVEN
    object_prior: str = GIVEN
    drift: tuple = ()  # V,W,VO,WO (m/s, rad/s): the true poses with this drift instead of the given priors
    event: str = ""  # one of derive.EVENTS
    settings: tuple = ()  # "section.key=value" for rf-run --set

    @property
    def derived(self):
        """Whether files that this tool writes go into it."""
        priors = {self.camera_prior, self.object_prior}
        return bool(self.event or priors & {FROZEN, JUMPING} or self.cut_recording)

    @property
    def cut_recording(self):
        return self.sequence.recorded and bool(self.sequence.start or self.sequence.frames)

    @property
    def label(self):
        parts = [self.sequence.name, self.mode]
        if self.camera_prior != GIVEN:
            parts.append(f"camera prior {self.camera_prior}")
        if self.object_prior != GIVEN:
            parts.append(f"object prior {self.object_prior}")
        if self.drift:
            parts.append("drift " + ",".join(f"{d:g}" for d in self.drift))
        return ", ".join(parts + ([self.event] if self.event else []) + list(self.settings))

    def description(self):
        return dataclasses.asdict(self)


@dataclasses.dataclass(frozen=True)
class Case:
    """A run as one row of an experiment's table; tags are the row's labels."""
    run: Run
    tags: tuple  # of (name, value)

    @staticmethod
    def of(run, **tags):
        return Case(run, tuple(tags.items()))
