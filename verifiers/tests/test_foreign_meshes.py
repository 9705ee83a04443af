"""Meshes of other meshers, with what is known about each. A program that is not installed skips its test."""

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

VERIFIER = os.environ["PODM_VERIFIER"]
CUBE = """8 3 0 0
1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1
6 0
1\n4 1 2 3 4\n1\n4 5 6 7 8\n1\n4 1 2 6 5\n1\n4 2 3 7 6\n1\n4 3 4 8 7\n1\n4 4 1 5 8
0\n0
"""


class ForeignMeshTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_program(self, name, *arguments):
        if shutil.which(name) is None:
            self.skipTest(f"{name} is not installed")
        subprocess.run([name, *arguments], cwd=self.folder, capture_output=True, check=True, timeout=120)

    def verdicts(self, mesh, *options):
        report = self.folder / "report.json"
        subprocess.run([VERIFIER, self.folder / mesh, "--quiet", "--json", report, *options], check=False, timeout=120)
        self.report = json.loads(report.read_text())
        return {name: claim["verdict"] for name, claim in self.report["claims"].items()}

    def test_tetgen_triangulates_points_by_delaunay(self):
        points = np.random.default_rng(3).uniform(size=(2000, 3))
        rows = [f"{i} {x:.17g} {y:.17g} {z:.17g}" for i, (x, y, z) in enumerate(points)]  # 0-based
        (self.folder / "points.node").write_text("2000 3 0 0\n" + "\n".join(rows) + "\n")
        self.run_program("tetgen", "-Q", "points.node")
        verdicts = self.verdicts("points.1.ele")
        self.assertEqual((verdicts["structure"], verdicts["delaunay"]), ("pass", "pass"))
        self.assertEqual(verdicts["radius_edge"], "fail", "random points have needles")

    def test_tetgen_gives_up_delaunay_where_it_optimises(self):
        (self.folder / "cube.poly").write_text(CUBE)
        self.run_program("tetgen", "-pq1.4a0.001Q", "cube.poly")
        verdicts = self.verdicts("cube.1.ele")
        self.assertEqual((verdicts["structure"], verdicts["surface"], verdicts["delaunay"]), ("pass", "pass", "fail"))

    def test_gmsh_meshes_are_sound_and_not_delaunay(self):
        (self.folder / "cube.geo").write_text('SetFactory("OpenCASCADE");\nBox(1) = {0,0,0,1,1,1};\n'
                                              "Physical Volume(7) = {1};\nMesh.MeshSizeMax = 0.2;\n")
        for arguments in (["-format", "msh41"], ["-algo", "hxt", "-format", "msh22"]):
            self.run_program("gmsh", "-3", "cube.geo", "-o", "cube.msh", *arguments)
            verdicts = self.verdicts("cube.msh")
            self.assertEqual({verdicts[claim] for claim in ("structure", "radius_edge", "surface")}, {"pass"})
            self.assertEqual(verdicts["delaunay"], "fail", "Gmsh optimises its meshes")


if __name__ == "__main__":
    unittest.main()
