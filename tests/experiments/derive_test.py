# SPDX-License-Identifier: BSD-3-Clause
"""Priors that fail and sequences with events."""
import math
import pathlib
import tempfile
import unittest
import zlib

from rf_experiments import derive, poses


def quaternion(axis, angle):
    return (*(math.sin(angle / 2) * a for a in axis), math.cos(angle / 2))


def walk(n=300, hz=30.0):
    """Along x with 0.5 m/s, turning slowly about z."""
    return [(f"{100 + i / hz:.6f}", ((0.5 * i / hz, 0.0, 1.0), quaternion((0, 0, 1), 0.002 * i))) for i in range(n)]


class Poses(unittest.TestCase):
    def test_products_follow_the_rotation(self):
        quarter = ((1.0, 0.0, 0.0), quaternion((0, 0, 1), math.pi / 2))
        moved = poses.product(quarter, ((2.0, 0.0, 0.0), (0, 0, 0, 1)))
        for found, true in zip(moved[0], (1.0, 2.0, 0.0)):
            self.assertAlmostEqual(found, true)

    def test_inverse_undoes(self):
        a = ((1.0, -2.0, 0.5), quaternion((0.6, 0.0, 0.8), 1.1))
        t, q = poses.product(a, poses.inverse(a))
        self.assertLess(max(map(abs, (*t, *q[:3]))), 1e-12)
        self.assertAlmostEqual(abs(q[3]), 1.0)

    def test_files_keep_times_as_written(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "poses.txt")
            poses.write(file, walk(5))
            self.assertEqual([t for t, _ in poses.read(file)], [t for t, _ in walk(5)])
            self.assertAlmostEqual(poses.path_length(poses.read(file)), 4 * 0.5 / 30)


class FailingPriors(unittest.TestCase):
    def test_frozen_moves_until_the_middle(self):
        given = walk()
        frozen = derive.frozen(given)
        self.assertEqual(frozen[:151], given[:151])
        self.assertEqual({pose for _, pose in frozen[150:]}, {given[150][1]})
        self.assertEqual([t for t, _ in frozen], [t for t, _ in given])

    def test_jumps_are_ten_centimetres_and_one_to_three_seconds_apart(self):
        given = walk(900)
        jumping = derive.jumping(given, seed=4)
        offsets = [tuple(a - b for a, b in zip(j[0], g[0])) for (_, j), (_, g) in zip(jumping, given)]
        jumps = [i for i in range(1, 900) if math.dist(offsets[i], offsets[i - 1]) > 1e-6]
        self.assertGreaterEqual(len(jumps), 9)
        for i in jumps:
            self.assertAlmostEqual(math.dist(offsets[i], offsets[i - 1]), 0.10)
        for a, b in zip(jumps, jumps[1:]):
            self.assertTrue(29 <= b - a <= 91, (a, b))
        self.assertEqual([q for _, (_, q) in jumping], [q for _, (_, q) in given])

    def test_the_seed_decides(self):
        self.assertEqual(derive.jumping(walk(), 1), derive.jumping(walk(), 1))
        self.assertNotEqual(derive.jumping(walk(), 1), derive.jumping(walk(), 2))


class Events(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.sequence = pathlib.Path(self.folder.name, "sequence")
        for sub in ("rgb", "depth", "mask"):
            (self.sequence / sub).mkdir(parents=True)
        truth = walk()
        for sub in ("rgb", "depth"):
            derive.write_list(self.sequence / f"{sub}.txt", [(t, f"{sub}/{t}.png") for t, _ in truth])
        for t, _ in truth:
            (self.sequence / "mask" / f"{t}.png").write_text(t)
        for name in ("groundtruth", "object_groundtruth", "odometry", "object_odometry"):
            poses.write(self.sequence / f"{name}.txt", truth)
        (self.sequence / "camera.yaml").write_text("width: 32\nheight: 24\nfx: 30\n")
        self.out = pathlib.Path(self.folder.name, "derived")

    def spoiled(self, event):
        derive.sequence_with(event, self.sequence, self.out)
        return [[i for i, (_, file) in enumerate(derive.image_list(self.out / f"{sub}.txt")) if "empty" in file]
                for sub in ("rgb", "depth")]

    def test_a_covered_lens_loses_both(self):
        first = derive.first_touched("lens covered", 300)
        self.assertEqual(self.spoiled("lens covered"), [list(range(first, first + 15))] * 2)
        self.assertEqual((self.out / "groundtruth.txt").read_text(), (self.sequence / "groundtruth.txt").read_text())

    def test_black_colour_keeps_depth(self):
        first = derive.first_touched("black colour", 300)
        self.assertEqual(self.spoiled("black colour"), [list(range(first, first + 10)), []])

    def test_depth_gone_keeps_colour(self):
        first = derive.first_touched("depth gone", 300)
        self.assertEqual(self.spoiled("depth gone"), [[], list(range(first, first + 15))])

    def test_teleport_moves_the_truth_a_metre_and_not_the_priors(self):
        derive.sequence_with("teleport", self.sequence, self.out)
        first = derive.first_touched("teleport", 300)
        truth = poses.read(self.out / "groundtruth.txt")
        prior = poses.read(self.out / "odometry.txt")
        steps = [poses.distance(a[1], b[1]) for a, b in zip(truth, truth[1:])]
        self.assertGreaterEqual(steps[first - 1], 1.0)
        self.assertLess(max(steps[:first - 1] + steps[first:]), 0.02)
        self.assertLess(max(poses.distance(a[1], b[1]) for a, b in zip(prior, prior[1:])), 0.02)
        self.assertEqual(len(truth), len(prior))
        self.assertEqual([t for t, _ in truth], [t for t, _ in walk()][:len(truth)])
        # Colour, depth and mask of a frame are those of the pose that the frame has.
        after = derive.image_list(self.out / "depth.txt")[first]
        self.assertEqual((self.out / "mask" / f"{after[0]}.png").read_text(), after[1][len("depth/"):-len(".png")])

    def test_a_camera_that_stays_cannot_teleport(self):
        poses.write(self.sequence / "groundtruth.txt", [(t, ((0, 0, 0), (0, 0, 0, 1))) for t, _ in walk()])
        with self.assertRaisesRegex(ValueError, "1 m"):
            derive.sequence_with("teleport", self.sequence, self.out)

    def test_a_cut_keeps_the_images_of_its_frames(self):
        derive.cut(self.sequence, self.out, 10, 20)
        self.assertEqual(derive.image_list(self.out / "depth.txt"),
                         derive.image_list(self.sequence / "depth.txt")[10:30])
        self.assertLessEqual(set(derive.image_list(self.sequence / "rgb.txt")[10:30]),
                             set(derive.image_list(self.out / "rgb.txt")))

    def test_empty_images_decode_to_zeros(self):
        data = derive.png(5, 3, 16, 1)
        begin = data.index(b"IDAT") + 4
        length = int.from_bytes(data[begin - 8:begin - 4], "big")
        self.assertEqual(zlib.decompress(data[begin:begin + length]), bytes(3 * (1 + 5 * 2)))
        self.assertEqual(data[16:24], (5).to_bytes(4, "big") + (3).to_bytes(4, "big"))


if __name__ == "__main__":
    unittest.main()
