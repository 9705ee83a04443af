"""An XDMF mesh in a solver: DOLFINx reads it in parallel and solves a Poisson equation on it."""

import json
import pathlib
import shutil
import subprocess
import sys
import unittest

from mpi_environment import mpi_environment
from podm_process import PodmTestCase, run_podm

SOLVER = pathlib.Path(__file__).with_name("solve_poisson.py")
OUTSIDE_TAGS = "1,2,3"  # pairs of labels are sorted, and each of the three spheres has a surface of its own


def can_solve():
    probe = subprocess.run([sys.executable, "-c", "import dolfinx"], capture_output=True, check=False)
    return probe.returncode == 0 and shutil.which("mpirun") is not None


def read_vtu(path):
    """Returns the volume of each label, and the box of the points, as VTK computes them."""
    import vtk
    from vtkmodules.util.numpy_support import vtk_to_numpy
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputConnection(reader.GetOutputPort())
    sizes.Update()
    data = sizes.GetOutput().GetCellData()
    volumes, labels = (vtk_to_numpy(data.GetArray(name)) for name in ("Volume", "label"))
    return ({str(label): volumes[labels == label].sum() for label in sorted(set(labels))},
            sizes.GetOutput().GetNumberOfCells(), sizes.GetOutput().GetNumberOfPoints(),
            sizes.GetOutput().GetLength())


class XdmfTest(PodmTestCase):
    def mesh(self, name):
        path = self.folder / name
        self.assert_exit(run_podm("mesh", "phantom:spheres", "--target-elements", 20000, "--threads", 1, "--quiet",
                                  "-o", path), 0)
        return path

    def solve(self, path, num_ranks):
        result = self.folder / "result.json"
        with mpi_environment() as environment:
            process = subprocess.run(["mpirun", "-n", str(num_ranks), sys.executable, "-B", SOLVER, path, OUTSIDE_TAGS,
                                      result], capture_output=True, text=True, timeout=240,
                                     env=environment | {"OMP_NUM_THREADS": "1"}, check=False)
        self.assert_exit(process, 0)
        return json.loads(result.read_text())

    @unittest.skipUnless(can_solve(), "needs the packages python3-dolfinx and openmpi-bin")
    def test_four_ranks_solve_poissons_equation(self):
        volumes, num_cells, num_points, diagonal = read_vtu(self.mesh("a.vtu"))
        found = self.solve(self.mesh("a.xdmf"), 4)
        self.assertEqual((found["ranks"], found["cells"], found["vertices"]), (4, num_cells, num_points))
        self.assertEqual(found["volumes"].keys(), volumes.keys())
        for label, volume in volumes.items():
            self.assertAlmostEqual(found["volumes"][label] / volume, 1, delta=1e-9)
        # The facets between labels have tags of their own: the facets to the outside are the whole outer boundary.
        self.assertAlmostEqual(found["outer_area_by_tags"] / found["outer_area"], 1, delta=1e-9)

        # In a ball of radius R around the object the solution is at most R^2 / 6, and the solution in the object is no
        # greater.
        self.assertGreater(found["minimum"], -1e-3 * found["maximum"])
        self.assertLess(found["maximum"], (diagonal / 2) ** 2 / 6)
        self.assertGreater(found["maximum"], 0)
        self.assertAlmostEqual(found["integral"] / found["energy"], 1, delta=1e-6)  # u is a test function, too

    def test_no_other_program_of_ours_reads_it(self):
        self.assert_refused(["mesh", "phantom:spheres", "--verify", "-o", self.folder / "a.xdmf"], "--verify",
                            "does not read")


if __name__ == "__main__":
    unittest.main()
