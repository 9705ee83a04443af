"""smooth=: facets of smoothed interfaces have the normals of the surface that was voxelised, and its volume."""

import unittest

import numpy as np

from balls import TestCase, podm

SIDE = 0.5
CENTER = np.array([15.3, 16.1, 15.7])


def sphere(points):
    return 10 - np.linalg.norm(points - CENTER, axis=-1)


def torus(points):
    offset = points - CENTER
    return 4 - np.hypot(np.hypot(offset[..., 0], offset[..., 1]) - 9, offset[..., 2])


SHAPES = {sphere: 4 / 3 * np.pi * 10**3, torus: 2 * np.pi**2 * 9 * 4**2}


def outward_normals(depth, points):
    step = 1e-5
    gradient = np.stack([(depth(points - step * axis) - depth(points + step * axis)) / (2 * step)
                         for axis in np.eye(3)], axis=-1)
    return gradient / np.linalg.norm(gradient, axis=-1, keepdims=True)


def made(depth, **options):
    """Returns the root mean square error of the facets' normals, degrees, and the mesh's volume."""
    index = np.stack(np.meshgrid(*[np.arange(64)] * 3, indexing="ij"), axis=-1)
    mesh = podm.mesh((depth(SIDE * index) > 0).astype(np.uint8), spacing=[SIDE] * 3, radius=2, delta=SIDE, **options)
    corners = mesh.points[mesh.facets]
    facet = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facet /= np.linalg.norm(facet, axis=1, keepdims=True)
    cosine = (facet * outward_normals(depth, corners.mean(axis=1))).sum(axis=1)
    cells = mesh.points[mesh.cells]
    edges = cells[:, 1:] - cells[:, :1]
    errors = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    return np.sqrt((errors**2).mean()), np.linalg.det(edges).sum() / 6


class SmoothTest(TestCase):
    def test_errors_of_normals_are_halved_and_volumes_kept(self):
        for depth, volume in SHAPES.items():
            stairs, _ = made(depth)
            for voxels in 1.5, 2:
                smoothed, of_mesh = made(depth, smooth=voxels * SIDE)
                self.assertLess(smoothed, stairs / 2, (depth.__name__, voxels))
                self.assertAlmostEqual(of_mesh / volume, 1, delta=0.005, msg=(depth.__name__, voxels))


if __name__ == "__main__":
    unittest.main()
