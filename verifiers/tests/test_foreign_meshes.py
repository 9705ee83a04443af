"""Meshes of other meshers, with the verdicts known for each. A mesher that is not installed skips its class."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

from inr_image import write_inr

VERIFIER = os.environ["PODM_VERIFIER"]
CUBE = """8 3 0 0
1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1
6 0
1\n4 1 2 3 4\n1\n4 5 6 7 8\n1\n4 1 2 6 5\n1\n4 2 3 7 6\n1\n4 3 4 8 7\n1\n4 4 1 5 8
0\n0
"""
BALL_IN_A_CUBE = """SetFactory("OpenCASCADE");
Box(1) = {0,0,0,1,1,1};
Sphere(2) = {0.5,0.5,0.5,0.3};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Physical Volume(7) = {2};
Physical Volume(8) = {3};
Mesh.MeshSizeMax = 0.15;
"""


def half_balls():
    """Returns voxels of a ball whose halves are labelled 1 and 2."""
    z, y, x = np.indices((32, 32, 32)) - 15.5
    return np.where(x * x + y * y + z * z < 12 ** 2, np.where(x > 0, 2, 1), 0)


class ForeignMeshes(unittest.TestCase):
    PROGRAM = None

    @classmethod
    def setUpClass(cls):
        if shutil.which(cls.PROGRAM) is None:
            print(f"skipped: {os.path.basename(cls.PROGRAM)} is not installed", file=sys.stderr)
            raise unittest.SkipTest("not installed")

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_program(self, *arguments):
        subprocess.run([self.PROGRAM, *arguments], cwd=self.folder, capture_output=True, check=True, timeout=120)

    def verdicts(self, mesh, *options):
        report = self.folder / "report.json"
        subprocess.run([VERIFIER, self.folder / mesh, "--quiet", "--json", report, *options], check=False, timeout=120)
        self.report = json.loads(report.read_text())
        return {name: claim["verdict"] for name, claim in self.report["claims"].items()}


class TetGenTest(ForeignMeshes):
    PROGRAM = "tetgen"

    def test_triangulates_points_by_delaunay(self):
        points = np.random.default_rng(3).uniform(size=(2000, 3))
        rows = [f"{i} {x:.17g} {y:.17g} {z:.17g}" for i, (x, y, z) in enumerate(points)]  # 0-based
        (self.folder / "points.node").write_text("2000 3 0 0\n" + "\n".join(rows) + "\n")
        self.run_program("-Q", "points.node")
        verdicts = self.verdicts("points.1.ele")
        self.assertEqual((verdicts["structure"], verdicts["delaunay"]), ("pass", "pass"))
        self.assertEqual(verdicts["radius_edge"], "fail", "random points have needles")

    def test_gives_up_delaunay_where_it_optimises(self):
        (self.folder / "cube.poly").write_text(CUBE)
        self.run_program("-pq1.4a0.001Q", "cube.poly")
        verdicts = self.verdicts("cube.1.ele")
        self.assertEqual((verdicts["structure"], verdicts["surface"], verdicts["delaunay"]), ("pass", "pass", "fail"))


class GmshTest(ForeignMeshes):
    PROGRAM = "gmsh"

    def test_meshes_are_sound_and_not_delaunay(self):
        (self.folder / "ball.geo").write_text(BALL_IN_A_CUBE)
        surfaces = []
        for arguments in (["-format", "msh41"], ["-format", "msh22"], ["-algo", "hxt", "-format", "msh41"],
                          ["-algo", "hxt", "-format", "msh22", "-bin"]):
            with self.subTest(arguments=arguments):
                self.run_program("-3", "ball.geo", "-o", "ball.msh", *arguments)
                verdicts = self.verdicts("ball.msh")
                self.assertEqual({verdicts[claim] for claim in ("structure", "conformity", "surface")}, {"pass"})
                self.assertEqual(verdicts["delaunay"], "fail", "Gmsh optimises its meshes")
                surfaces.append(self.report["claims"]["boundary_angles"]["reason"])
        self.assertEqual(len(set(surfaces)), 1, "every algorithm keeps the surface mesh")


class CgalTest(ForeignMeshes):
    PROGRAM = os.environ["PODM_CGAL_MESH3"]

    def verdicts_of_half_balls(self, *options):
        """Checks CGAL's mesh of two half balls with the bounds that it was given.

        Its vertices are on the image's surface to a thousandth of the image's radius, which is 28 voxels."""
        write_inr(self.folder / "balls.inr", half_balls())
        self.run_program("balls.inr", "--cell-size", "3", "--facet-distance", "0.5", "--output", "balls.mesh", *options)
        return self.verdicts("balls.mesh", "--image", self.folder / "balls.inr", "--radius", "3",
                             "--vertex-voxels", "0.028")

    def test_meshes_images_by_delaunay_refinement_and_keeps_every_claim(self):
        verdicts = self.verdicts_of_half_balls()
        self.assertEqual((len(verdicts), set(verdicts.values())), (10, {"pass"}))

    def test_gives_up_delaunay_where_it_weights_vertices_against_slivers(self):
        verdicts = self.verdicts_of_half_balls("--exude")
        self.assertEqual({verdicts[claim] for claim in ("structure", "conformity", "surface")}, {"pass"})
        self.assertEqual(verdicts["delaunay"], "fail")


if __name__ == "__main__":
    unittest.main()
