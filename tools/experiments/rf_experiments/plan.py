# SPDX-License-Identifier: BSD-3-Clause
"""What the command line asks of the experiments: seeds, scenes, cuts."""
import dataclasses

from .runs import Sequence

CAMERA_SCENES = ("straight", "orbit", "overtake", "sideway")
SIZES = (30, 40, 50, 55, 60, 65, 70, 75, 80, 85)  # largest share of the object, per cent of the valid pixels

OURS = "rigidfusion"
PAPER = "rigidfusion-paper"
BASELINES = ("vo", "static", "static-prior", PAPER)

QUICK_START = 30  # the objects of the camera scenes start to move at this frame
QUICK_START_SIZE = 20  # those of the size scenes are 1 cm away 17 frames after this
QUICK_FRAMES = 60


@dataclasses.dataclass(frozen=True)
class Plan:
    seeds: tuple = (1, 2, 3, 4, 5)
    baseline_seeds: tuple = (1, 2)
    scenes: tuple = ()  # only these, when any are given
    quick: bool = False
    knows: object = lambda setting: True  # whether rf-run has such a setting
    recordings: tuple = ()  # folders that are there
    known_scenes: tuple = ()  # of rf-simulate
    noises: tuple = (1.0,)  # factors on the sensor's noise that rf-simulate can make

    def choose(self, names, quick):
        """The names of an experiment that this plan covers; `quick`: which of them quick runs take."""
        names = [n for n in names if not self.scenes or n in self.scenes]
        return [n for n in names if n in quick] if self.quick else names

    def sequence(self, scene, seed, start=0, frames=0):
        """A scene, in quick plans always a short cut of it."""
        if self.quick:
            first = QUICK_START_SIZE if scene.startswith("size") else QUICK_START
            return Sequence(scene, seed, first, QUICK_FRAMES)
        return Sequence(scene, seed, start, frames)

    def modes(self, baselines):
        """[(mode, seeds)]: baselines on few seeds, ours on all."""
        if self.quick:
            baselines = [b for b in baselines if b in ("vo", PAPER)]
        return [(b, self.baseline_seeds) for b in baselines] + [(OURS, self.seeds)]


def size_scene(per_cent):
    return f"size{per_cent:03d}"
