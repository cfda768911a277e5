"""Tests of the wheel as it is installed. `make wheel` runs them."""

import doctest
import math
import unittest

import numpy as np

import isostudy

AXIS = np.linspace(-1.25, 1.25, 41, dtype=np.float32)
SPACING = float(AXIS[1] - AXIS[0])
X, Y, Z = np.meshgrid(AXIS, AXIS, AXIS, indexing="ij")
BALL = 1 - np.sqrt(X * X + Y * Y + Z * Z)
VOLUME = 4 / 3 * math.pi


def noise(seed, n=9):
    """White noise with walls of -1, so that every surface is closed."""
    samples = np.random.default_rng(seed).uniform(-1, 1, (n, n, n)).astype(np.float32)
    for axis in range(3):
        samples[(slice(None),) * axis + ([0, -1],)] = -1
    return samples


class Extraction(unittest.TestCase):
    def test_a_ball_by_every_method(self):
        self.assertGreater(len(isostudy.methods()), 25)
        for method in isostudy.methods():
            with self.subTest(method.id):
                mesh = isostudy.extract(BALL, method=method.id, spacing=SPACING, origin=-1.25)
                self.assertEqual((mesh.vertices.dtype, mesh.faces.dtype), (np.float32, np.uint32))
                self.assertEqual(mesh.normals.shape, mesh.vertices.shape)
                self.assertLess(abs(mesh.volume / VOLUME - 1), 0.05)
                if method.is_manifold:
                    found = isostudy.topology(mesh)
                    self.assertTrue(found["is_closed_manifold"])
                    self.assertEqual(found["euler_characteristic"], 2)

    def test_vertices_lie_where_the_samples_are(self):
        """Three unequal axes: each coordinate belongs to its own axis of the array."""
        i, j, k = np.meshgrid(np.arange(24), np.arange(20), np.arange(16), indexing="ij")
        centre, radii = (12, 9, 8), (9, 6, 5)
        parts = [((of - c) / r) ** 2 for of, c, r in zip((i, j, k), centre, radii)]
        mesh = isostudy.extract(1 - np.sqrt(sum(parts)), spacing=(0.5, 1, 2), origin=(10, 20, 30))
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        for axis, (spacing, origin) in enumerate([(0.5, 10), (1, 20), (2, 30)]):
            self.assertAlmostEqual(low[axis], origin + spacing * (centre[axis] - radii[axis]), places=3)
            self.assertAlmostEqual(high[axis], origin + spacing * (centre[axis] + radii[axis]), places=3)
        outward = mesh.vertices - np.array([16, 29, 46])
        self.assertGreater((outward * mesh.normals).sum(axis=1).min(), 0)
        self.assertGreater(mesh.volume, 0)

    def test_the_order_in_memory_does_not_matter(self):
        samples = noise(3)
        expected = isostudy.extract(samples)
        for other in [np.asfortranarray(samples), samples.astype(np.float64), np.repeat(samples, 2, axis=2)[:, :, ::2]]:
            mesh = isostudy.extract(other)
            self.assertEqual(mesh.vertices.tobytes(), expected.vertices.tobytes())
            self.assertEqual(mesh.faces.tobytes(), expected.faces.tobytes())

    def test_any_number_of_threads_gives_the_same_bytes(self):
        one, *others = [isostudy.extract(BALL, method="bi", threads=threads) for threads in (1, 2, 5, 0)]
        for other in others:
            for name in ("vertices", "normals", "faces"):
                self.assertEqual(getattr(one, name).tobytes(), getattr(other, name).tobytes())

    def test_nothing_is_copied(self):
        mesh = isostudy.extract(BALL)
        for name in ("vertices", "normals", "faces"):
            array = getattr(mesh, name)
            self.assertFalse(array.flags.owndata)
            self.assertFalse(array.flags.writeable)
            self.assertTrue(np.shares_memory(array, np.asarray(getattr(mesh._native, name)())))
        # The arrays keep the memory that they read.
        vertices, total = mesh.vertices, mesh.vertices.sum()
        del mesh
        self.assertEqual(vertices.sum(), total)
        frozen = BALL.copy()
        frozen.flags.writeable = False
        self.assertEqual(len(isostudy.extract(frozen).faces), len(isostudy.extract(BALL).faces))

    def test_no_surface_is_an_empty_mesh(self):
        mesh = isostudy.extract(BALL, isovalue=5)
        self.assertEqual((mesh.vertices.shape, mesh.faces.shape, mesh.volume), ((0, 3), (0, 3), 0))

    def test_mistakes_are_said(self):
        for call, words in [
            (lambda: isostudy.extract(BALL, method="mc34"), "mc33"),
            (lambda: isostudy.extract(BALL[0]), "2 axes"),
            (lambda: isostudy.extract(BALL[:1]), "two or more"),
            (lambda: isostudy.extract(BALL, isovalue=math.nan), "finite"),
            (lambda: isostudy.extract(BALL, spacing=0), "span no space"),
            (lambda: isostudy.extract(BALL, spacing=(1, 2)), "three of them"),
            (lambda: isostudy.Mesh([[0, 0, 0]], [[0, 0, 1]]), "vertex 1"),
            (lambda: isostudy.Mesh([[0, 0, 0]], [[0, 0, -1]]), "whole numbers"),
            (lambda: isostudy.Mesh([[0, 0]], [[0, 0, 0]]), "three a row"),
        ]:
            with self.assertRaisesRegex(ValueError, words):
                call()
        with self.assertRaisesRegex(TypeError, "real numbers"):
            isostudy.extract(BALL.astype(complex))


class Measures(unittest.TestCase):
    def test_one_triangle_is_measured_by_hand(self):
        mesh = isostudy.Mesh([[0, 0, 0], [3, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        found = isostudy.quality(mesh)
        self.assertEqual((found["triangles"], found["degenerate"], found["shortest_edge"]), (1, 0, 3))
        self.assertAlmostEqual(found["area"]["mean"], 6)
        # Twice the inner radius by the outer one: 2 * 1 / 2.5.
        self.assertAlmostEqual(found["radius_ratio"]["mean"], 0.8)
        self.assertAlmostEqual(found["min_angle_deg"]["min"], math.degrees(math.atan2(3, 4)))
        self.assertEqual(isostudy.topology(mesh)["boundary_edges"], 3)

    def test_mc33_has_the_topology_of_noise_and_mc_has_not(self):
        verdicts = {"mc33": [], "mc": []}
        for seed in range(40):
            samples = noise(seed)
            for method, of_method in verdicts.items():
                of_method.append(isostudy.verify(isostudy.extract(samples, method=method), samples))
        self.assertTrue(all(verdict["is_right"] for verdict in verdicts["mc33"]))
        wrong = [verdict for verdict in verdicts["mc"] if not verdict["is_right"]]
        self.assertGreater(len(wrong), 30)
        for verdict in wrong:
            self.assertTrue(verdict["findings"])
            self.assertNotEqual(verdict["found"], verdict["expected"])

    def test_the_documentation_runs(self):
        failed, tried = doctest.testmod(isostudy)
        self.assertGreater(tried, 3)
        self.assertEqual(failed, 0)


if __name__ == "__main__":
    unittest.main()
