"""podm-verify-mpi: whatever the mesh and the number of ranks, its report is that of podm-verify."""

import json
import math
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

from inr_image import write_inr
from medit_mesh import kuhn_cubes
from pvtu_mesh import MeshInPieces
from test_pieces import PiecesTest, cubes_of_two_labels

VERIFIER, ON_RANKS = os.environ["PODM_VERIFIER"], os.environ["PODM_VERIFIER_MPI"]
RANKS = 1, 2, 3, 5
SCHEDULE = json.dumps({"schema": "podm-schedule/1", "algorithm": "pdr-podm",
                       "mesh_to_grid": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0], "leaves": [[0, 0, 0, 8]]}) + "\n"
OWN_TO_A_RUN = "program", "ranks", "seconds", "peak_rss_bytes", "threads"


def differences(a, b, place=""):
    """Yields the places where two reports differ by more than the order of sums."""
    if isinstance(a, dict) and isinstance(b, dict):
        for key in {*a, *b} - {*OWN_TO_A_RUN}:
            yield from differences(a.get(key), b.get(key), f"{place}.{key}")
    elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for i, (x, y) in enumerate(zip(a, b)):
            yield from differences(x, y, f"{place}[{i}]")
    elif isinstance(a, float) and isinstance(b, float):
        if not math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12):
            yield f"{place}: {a} or {b}"
    elif a != b:
        yield f"{place}: {a} or {b}"


def shaken(mesh, random):
    """Returns the mesh with some faults: vertices moved, cells dropped, doubled, relabelled, turned or added."""
    mesh = mesh.copy()
    for _ in range(random.integers(4)):
        c, v = random.integers(len(mesh.cells)), random.integers(len(mesh.vertices))
        fault = random.integers(9)
        if fault == 0:
            mesh.vertices[v] += random.normal(size=3) * 0.7
        elif fault == 1:
            mesh.cells = np.delete(mesh.cells, c, axis=0)
        elif fault == 2:
            mesh.cells = np.append(mesh.cells, mesh.cells[c:c + 1, [1, 2, 0, 3, 4]], axis=0)
        elif fault == 3:
            mesh.cells[c, 4] = random.integers(4)
        elif fault == 4:
            mesh.cells[c, [2, 3]] = mesh.cells[c, [3, 2]]
        elif fault == 5:  # a cell on a facet that has two already, with a vertex that is far away
            mesh.cells = np.append(mesh.cells, [[*mesh.cells[c, :3], v, 1]], axis=0)
        elif fault == 6:
            mesh.vertices[v] = mesh.vertices[random.integers(len(mesh.vertices))]
        elif fault == 7:
            mesh.vertices = np.append(mesh.vertices, random.normal(size=(2, 3)), axis=0)
        elif len(mesh.facets) > 0:
            f = random.integers(len(mesh.facets))
            mesh.facets[f, :3] = mesh.facets[f, [0, 2, 1]] if random.integers(2) else mesh.facets[f - 1, :3]
    return mesh


def write_image_of_two_labels(folder, length):
    voxels = np.ones((2, 3, length), dtype=np.uint8)
    voxels[1:] = 2
    write_inr(folder / "image.inr", voxels)
    return folder / "image.inr"


class ReportTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.index = self.folder / "m.pvtu"
        image = write_image_of_two_labels(self.folder, 4)
        self.options = ["--image", image, "--radius", "0.9", "--min-dihedral", "20", "--delta", "0.3"]

    def report(self, program, *options):
        path = self.folder / "report.json"
        path.unlink(missing_ok=True)
        process = subprocess.run([program, self.index, "--json", path, *self.options, *options], capture_output=True,
                                 text=True, timeout=120, check=False)
        self.assertIn(process.returncode, (0, 1), process.stdout + process.stderr)
        return process.returncode, json.loads(path.read_text())

    def assert_same_reports(self, *options):
        code, expected = self.report(VERIFIER, *options)
        for num_ranks in RANKS:
            found_code, found = self.report(ON_RANKS, *options, "--in-process", str(num_ranks))
            self.assertEqual(list(differences(expected, found)), [], f"{num_ranks} ranks")
            self.assertEqual(found_code, code)

    def test_reports_are_those_of_one_process(self):
        for seed in range(24):
            random = np.random.default_rng(seed)
            mesh = shaken(cubes_of_two_labels(), random)
            with self.subTest(seed):
                MeshInPieces(mesh, int(random.integers(1, 8))).write(self.index)
                self.assert_same_reports()

    def test_reports_of_a_mesh_without_labels_or_facets(self):
        mesh = kuhn_cubes(3, 2, 2)
        for seed in range(6):
            with self.subTest(seed):
                MeshInPieces(shaken(mesh, np.random.default_rng(seed)), 4).write(self.index)
                for file in self.folder.glob("m*.vtu"):
                    file.write_text(file.read_text().replace('Name="label"', 'Name="other"'))
                for file in self.folder.glob("m*_facets.*vtu"):
                    file.unlink()
                self.assert_same_reports()

    def test_bounds_near_lines(self):
        for seed in range(6):
            with self.subTest(seed):
                MeshInPieces(shaken(cubes_of_two_labels(), np.random.default_rng(seed)), 5).write(self.index)
                self.assert_same_reports("--lines-delta", "1", "--claims", "radius_edge,boundary_angles")

    def test_lines_are_left_out(self):
        MeshInPieces(cubes_of_two_labels(), 3).write(self.index)
        _, report = self.report(ON_RANKS, "--lines-delta", "1", "--in-process", "2")
        self.assertNotIn("lines", report["claims"])
        process = subprocess.run([ON_RANKS, self.index, "--claims", "lines", "--lines-delta", "1", *self.options,
                                  "--in-process", "2"], capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(process.returncode, 2)
        self.assertIn("--claims lines: not on ranks", process.stderr)

    def test_unsound_references(self):
        mesh = cubes_of_two_labels()
        mesh.cells[3, 1] = 10 ** 6
        mesh.vertices[7, 1] = math.nan
        MeshInPieces(mesh, 4).write(self.index)
        self.assert_same_reports()

    def test_mesh_without_cells(self):
        mesh = cubes_of_two_labels()
        mesh.cells, mesh.facets = mesh.cells[:0], mesh.facets[:0]
        MeshInPieces(mesh, 2).write(self.index)
        self.assert_same_reports()

    def test_bad_cells_are_those_of_one_process(self):
        mesh = shaken(cubes_of_two_labels(), np.random.default_rng(5))
        mesh.cells[::7, [2, 3]] = mesh.cells[::7, [3, 2]]
        MeshInPieces(mesh, 5).write(self.index)
        files = []
        for program, *options in (VERIFIER,), *((ON_RANKS, "--in-process", str(n)) for n in RANKS):
            self.report(program, *options, "--extract-bad", self.folder / "bad.vtu")
            files.append((self.folder / "bad.vtu").read_bytes())
        for found in files[1:]:
            self.assertEqual(found, files[0])


class RefusalTest(PiecesTest):
    """The pieces that podm-verify refuses are refused on ranks, too."""
    PREFIX = "podm-verify-mpi: "

    def verify(self, path, *options):
        codes = set()
        for num_ranks in 4, 2, 1:
            process = subprocess.run([ON_RANKS, path, *options, "--in-process", str(num_ranks)], capture_output=True,
                                     text=True, timeout=60, check=False)
            codes.add(process.returncode)
        self.assertEqual(len(codes), 1, process.stderr)
        return process

    def report(self, path):
        return super().report(path) if path.suffix == ".pvtu" else self.report_of_whole(path)

    def report_of_whole(self, path):
        report = self.folder / "whole.json"
        subprocess.run([VERIFIER, path, "--json", report], capture_output=True, timeout=60, check=True)
        return json.loads(report.read_text())

    def test_a_mesh_that_is_not_in_pieces(self):
        process = self.verify(self.folder / "m.mesh")
        self.assertEqual(process.returncode, 2)
        self.assertIn("m.mesh: not a mesh in pieces", process.stderr)


class MpiTest(unittest.TestCase):
    """The processes of mpirun."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.index = self.folder / "m.pvtu"
        MeshInPieces(cubes_of_two_labels(), 3).write(self.index)

    def run_ranks(self, num_ranks, *arguments):
        return self.run_mpi("-n", num_ranks, ON_RANKS, *arguments)

    def run_mpi(self, *arguments):
        environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                           OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_mpi_yield_when_idle="1")
        return subprocess.run([os.environ["PODM_MPIRUN"], *map(str, arguments)], capture_output=True, text=True,
                              timeout=120, check=False, env=environment)

    def test_exit_codes_and_texts(self):
        for arguments, code, text in (([self.index], 0, " claims pass"), ([self.index, "--angle", "50"], 1, "fail"),
                                      ([self.index, "--json", "/dev/full"], 2, "/dev/full: cannot be written"),
                                      (["--version"], 0, "podm-verify-mpi "), (["--nonsense"], 2, "MESH is required"),
                                      ([self.index, "--in-process", "2"], 2, "MPI has started 2 processes"),
                                      ([self.index.with_name("none.pvtu")], 2, "No such file")):
            with self.subTest(arguments):
                process = self.run_ranks(2, *arguments)
                self.assertEqual(process.returncode, code, process.stdout + process.stderr)
                self.assertEqual((process.stdout + process.stderr).count(text), 1, process.stdout + process.stderr)

    def test_claims_about_an_image(self):
        image = write_image_of_two_labels(self.folder, 4)
        options = self.index, "--image", image, "--claims", "labels,surface_vertices,fidelity", "--json"
        expected = subprocess.run([VERIFIER, *options, self.folder / "one.json"], capture_output=True, check=False)
        process = self.run_ranks(2, *options, self.folder / "ranks.json")
        self.assertEqual(process.returncode, expected.returncode, process.stdout + process.stderr)
        one, ranks = (json.loads((self.folder / f"{name}.json").read_text()) for name in ("one", "ranks"))
        self.assertEqual(list(differences(one, ranks)), [])

    def assert_refused(self, process, *texts):
        self.assertEqual(process.returncode, 2, process.stdout + process.stderr)
        for text in "rank 1 of 2 does not have the ", *texts:
            self.assertEqual(process.stderr.count(text), 1, process.stderr)
        self.assertFalse((self.folder / "report.json").exists())

    def test_other_files_on_a_rank(self):
        folders = self.folder / "a", self.folder / "b"
        for folder in folders:
            folder.mkdir()
            MeshInPieces(cubes_of_two_labels(), 3).write(folder / "m.pvtu")
            (folder / "leaves.jsonl").write_text(SCHEDULE)
            write_image_of_two_labels(folder, 4)
        command = [ON_RANKS, "m.pvtu", "--image", "image.inr", "--size-image", "image.inr",
                   "--schedule", "leaves.jsonl", "--json", self.folder / "report.json"]
        launch = ["-n", 1, "-wdir", folders[0], *command, ":", "-n", 1, "-wdir", folders[1], *command]
        self.assertIn(self.run_mpi(*launch).returncode, (0, 1))
        (self.folder / "report.json").unlink()
        (folders[1] / "leaves.jsonl").write_text(SCHEDULE.replace("8]", "16]"))
        self.assert_refused(self.run_mpi(*launch), "leaves.jsonl of rank 0: SHA-256")
        write_image_of_two_labels(folders[1], 5)
        self.assert_refused(self.run_mpi(*launch), "image.inr of rank 0: SHA-256")
        MeshInPieces(cubes_of_two_labels(), 2).write(folders[1] / "m.pvtu")
        self.assert_refused(self.run_mpi(*launch), "m.pvtu of rank 0: SHA-256")

    def test_other_options_on_a_rank(self):
        command = [ON_RANKS, self.index, "--json", self.folder / "report.json", "--angle"]
        process = self.run_mpi("-n", 1, *command, 30, ":", "-n", 1, *command, 29)
        self.assert_refused(process, "command line of rank 0: ", "--angle 29, not ", "--angle 30\n")


if __name__ == "__main__":
    unittest.main()
