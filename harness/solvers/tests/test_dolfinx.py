"""Tests of ../dolfinx: linear fields are reproduced, eigenvalues are those of the matrix, bad meshes are refused."""
import importlib.util
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

FOLDER = pathlib.Path(__file__).resolve().parents[1] / "dolfinx"
sys.path.insert(0, str(FOLDER))
HAS_DOLFINX = all(importlib.util.find_spec(name) for name in ("dolfinx", "meshio", "vtk"))
if HAS_DOLFINX:
    import conjugate_gradients
    import read_mesh
    import systems


def cube(side=6, shear=0.3):
    """Returns points and cells of a sheared cube of side^3 cubes of six tetrahedra, inner points moved at random."""
    steps = np.stack(np.meshgrid(*[np.arange(side + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    at = lambda corner: corner @ np.array([(side + 1)**2, side + 1, 1])
    corners = steps[(steps < side).all(axis=1)]
    cells = []
    for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (1, 0, 2), (2, 1, 0)):
        path = np.cumsum([np.zeros(3, int), *np.eye(3, dtype=int)[list(order)]], axis=0)
        cells.append(np.stack([at(corners + step) for step in path], axis=1))
    is_inside = ((steps > 0) & (steps < side)).all(axis=1)
    moved = steps + 0.2 * np.random.default_rng(1).uniform(-1, 1, steps.shape) * is_inside[:, None]
    return moved @ (np.eye(3) + shear * np.eye(3, k=1)), np.concatenate(cells)


MESH_TEXT = "MeshVersionFormatted 2\nDimension 3\nVertices\n{n}\n{points}\nTetrahedra\n{m}\n{cells}\nEnd\n"


def medit(points, cells):
    lines = lambda rows, end: "\n".join(" ".join(map(str, row)) + end for row in rows.tolist())
    return MESH_TEXT.format(n=len(points), m=len(cells), points=lines(points, " 0"), cells=lines(cells + 1, " 1"))


def run(*arguments):
    return subprocess.run([FOLDER / "run", *arguments], capture_output=True, text=True, check=False)


@unittest.skipUnless(HAS_DOLFINX, "needs the packages python3-dolfinx and python3-meshio")
class Systems(unittest.TestCase):
    def values_of(self, system, preconditioner):
        solution, measured = conjugate_gradients.solve(system, preconditioner)
        self.assertGreater(measured.iterations, 0)
        return solution.getArray().reshape(-1, system.space.dofmap.index_map_bs)

    def test_linear_fields_are_reproduced(self):
        """The patch test: P1 elements contain linear fields, and these need no force inside."""
        domain = systems.domain_of(*cube())
        slope = np.array([[0.5, -1, 2], [3, 0.25, -0.5], [1, 1, -2]])
        made = [(systems.poisson(domain, lambda x: 1 + slope[0] @ x, source=0), slope[:1]),
                (systems.elasticity(domain, lambda x: 1 + slope @ x, force=(0, 0, 0)), slope)]
        for system, matrix in made:
            expected = 1 + system.space.tabulate_dof_coordinates() @ matrix.T
            for preconditioner in conjugate_gradients.PRECONDITIONERS:
                found = self.values_of(system, preconditioner)
                self.assertLess(abs(found - expected).max(), 1e-6 * abs(expected).max())

    def test_a_source_lifts_a_membrane_as_a_series_says(self):
        """In a unit cube with u = 0 on its boundary, the solution of -div grad u = 1 is 0.0562 in the middle."""
        points, cells = cube(16, shear=0)
        system = systems.poisson(systems.domain_of(points / 16, cells))
        self.assertAlmostEqual(self.values_of(system, "jacobi").max() / 0.0562, 1, delta=0.03)

    def test_eigenvalues_are_those_of_the_preconditioned_matrix(self):
        system = systems.poisson(systems.domain_of(*cube(5)), source=1)
        _, measured = conjugate_gradients.solve(system, "jacobi")
        dense = system.matrix.convert("dense").getDenseArray()
        scale = 1 / np.sqrt(dense.diagonal())
        eigenvalues = np.linalg.eigvalsh(scale[:, None] * dense * scale)
        self.assertAlmostEqual(measured.largest_eigenvalue / eigenvalues[-1], 1, delta=0.02)
        self.assertAlmostEqual(measured.smallest_eigenvalue / eigenvalues[0], 1, delta=0.02)

    def test_multigrid_knows_rigid_motions(self):
        """Rigid motions have no strain: the matrix maps them to 0 at each point without a neighbour of known value."""
        system = systems.elasticity(systems.domain_of(*cube(6, shear=0)))
        is_far_inside = np.abs(system.space.tabulate_dof_coordinates() - 3).max(axis=1) < 1.5
        self.assertEqual(is_far_inside.sum(), 27)
        motions = system.matrix.getNearNullSpace().getVecs()
        self.assertEqual(np.linalg.matrix_rank([motion.getArray() for motion in motions]), 6)
        for motion in motions:
            force = motion.duplicate()
            system.matrix.mult(motion, force)
            self.assertLess(abs(force.getArray().reshape(-1, 3)[is_far_inside]).max(), 1e-12)


@unittest.skipUnless(HAS_DOLFINX, "needs the packages python3-dolfinx and python3-meshio")
class Program(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def test_it_reports_iterations_of_each_system(self):
        points, cells = cube()
        found = run(self.write("cube.mesh", medit(np.vstack([points, [[99, 99, 99]]]), cells)))
        self.assertEqual(found.returncode, 0, found.stderr)
        report = json.loads(found.stdout)
        self.assertEqual((report["poisson"]["unknowns"], report["elasticity"]["unknowns"]), (5**3, 3 * 5**3))
        for system in ("poisson", "elasticity"):
            for preconditioner in ("jacobi", "amg"):
                one = report[system][preconditioner]
                self.assertGreater(one["iterations"], 0)
                self.assertGreater(one["largest_eigenvalue"], one["smallest_eigenvalue"])
                self.assertGreater(one["smallest_eigenvalue"], 0)

    def test_formats_hold_the_same_mesh(self):
        import meshio
        points, cells = cube(3)
        for name, kind in (("a.vtu", "vtu"), ("a.msh", "gmsh"), ("a.mesh", "medit"), ("a.node", "tetgen")):
            meshio.write(self.folder / name, meshio.Mesh(points, [("tetra", cells)]), kind)
        for name in ("a.vtu", "a.msh", "a.mesh", "a.ele"):
            read_points, read_cells = read_mesh.read_mesh(str(self.folder / name))
            self.assertTrue(np.allclose(read_points[read_cells], points[cells], rtol=0, atol=1e-9), name)

    def test_bad_files_are_refused_with_file_and_fault(self):
        points, cells = cube(2)
        with_nan, flat, beyond = points.copy(), points.copy(), cells.copy()
        with_nan[cells[7, 2]] = np.nan
        flat[:, 2] = 0
        beyond[5, 3] = len(points) + 3
        one = (np.eye(4, 3), np.array([[0, 1, 2, 3]]))
        made = {"nothing.mesh": (None, "no such file"),
                "text.vtu": ("no grid", "VTK"),
                "text.mesh": ("no mesh", "medit"),
                "half.msh": ("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 9", "gmsh"),
                "mesh.stl": ("solid", "ends with none"),
                "empty.mesh": (MESH_TEXT.format(n=1, points="0 0 0 0", m=0, cells=""), "tetrahedra"),
                "nan.mesh": (medit(with_nan, cells), "not finite"),
                "flat.mesh": (medit(flat, cells), "cell 0 is flat"),
                "beyond.mesh": (medit(points, beyond), "cell 5 names a point")}
        for name, (text, fault) in made.items():
            path = self.folder / name if text is None else self.write(name, text)
            found = run(path)
            self.assertEqual((found.returncode, found.stdout), (2, ""), name + found.stderr)
            self.assertIn(str(path), found.stderr)
            self.assertIn(fault, found.stderr)
        found = run(self.write("one.mesh", medit(*one)))
        self.assertEqual((found.returncode, found.stdout), (1, ""))
        self.assertIn("nothing is unknown", found.stderr)

    def test_it_reports_its_version(self):
        found = run("--version")
        self.assertEqual(found.returncode, 0)
        self.assertRegex(found.stdout, r"^DOLFINx \S+ .*PETSc \S+")


if __name__ == "__main__":
    unittest.main()
