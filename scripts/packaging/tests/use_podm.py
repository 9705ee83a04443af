"""Uses an installation of podm as a new user does: the programs on the PATH and the Python package, on a system that
has Python and numpy and perhaps nothing else. ci/packages.sh runs this file inside such systems.

Environment: PODM_EXPECTED_VERSION; PODM_WITHOUT_PACKAGE=1 if the installation holds the programs only."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

WITHOUT_PACKAGE = bool(os.environ.get("PODM_WITHOUT_PACKAGE"))
ENDINGS = (".vtu", ".vtk", ".msh", ".mesh", ".inp", ".e", ".exo", ".ele", ".xdmf")
READ_BY_VERIFIER = set(ENDINGS) - {".xdmf"}
NRRD = ("NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 16 16 16\n"
        "space directions: (1,0,0) (0,1,0) (0,0,1)\nkinds: domain domain domain\nencoding: raw\n"
        "space origin: (0,0,0)\n\n")
SEGMENTS = "Segment0_Name:=cube\nSegment0_LabelValue:=1\nSegment0_Layer:=0\nSegment0_Color:=1 0 0\n\n"
EXPERIMENT = """
title = "Small"
claim = "A phantom is meshed."
expected_minutes = 1
[[claims]]
name = "guarantees"
statement = "No cell or boundary facet of the phantom misses a guarantee."
basis = "measured"
trials = ["spheres"]
kind = "bound"
value = "guarantee_misses"
at_most = 0
[inputs.spheres]
image = "phantom:spheres@16"
[[trials]]
name = "spheres"
input = "spheres"
radius_mm = 5.0
"""


def cube():
    """Returns the voxels of an image of 16 x 16 x 16 with a cube of label 1."""
    inside = range(4, 12)
    return bytes(int(x in inside and y in inside and z in inside) for z in range(16) for y in range(16)
                 for x in range(16))


class Installation(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_program(self, *words, exit_code=0):
        done = subprocess.run([str(word) for word in words], cwd=self.folder, capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, exit_code, f"{words}\n{done.stdout}{done.stderr}")
        return done

    def test_programs_report_the_version_of_the_package(self):
        for program in ("podm", "podm-verify", "podm-bench"):
            first_line = self.run_program(program, "--version").stdout.splitlines()[0]
            self.assertEqual(first_line.split()[1], os.environ["PODM_EXPECTED_VERSION"], first_line)

    def test_images_of_each_reader_are_meshed_and_proved(self):
        self.run_program("podm", "phantom", "spheres", "--size", "16", "-o", "a.nii.gz")
        (self.folder / "a.nrrd").write_bytes(NRRD.encode() + cube())
        (self.folder / "a.seg.nrrd").write_bytes(NRRD[:-1].encode() + SEGMENTS.encode() + cube())
        (self.folder / "a.raw").write_bytes(cube())
        (self.folder / "a.mhd").write_text("NDims = 3\nDimSize = 16 16 16\nElementType = MET_UCHAR\n"
                                           "ElementSpacing = 1 1 1\nElementDataFile = a.raw\n")
        self.assertRegex(self.run_program("podm", "info", "a.seg.nrrd").stdout, "#ff0000 +cube")
        for image in ("a.nii.gz", "a.nrrd", "a.seg.nrrd", "a.mhd"):
            self.run_program("podm", "info", image)
            self.run_program("podm", "mesh", image, "--radius", "5", "--threads", "2", "--verify", "--quiet", "-o",
                             "a.vtu")
            self.run_program("podm-verify", "a.vtu", "--image", image)

    def test_meshes_of_each_writer_are_read_by_the_verifier(self):
        for ending in ENDINGS:
            self.run_program("podm", "mesh", "phantom:spheres@16", "--radius", "5", "--quiet", "-o", "a" + ending)
            self.assertGreater((self.folder / ("a" + ending)).stat().st_size, 0)
            if ending in READ_BY_VERIFIER:
                self.run_program("podm-verify", "a" + ending)
        self.run_program("podm", "mesh", "phantom:spheres@16", "--radius", "5", "--quiet", "-o", "b.vtu", "--surface",
                         "b.stl", "--record", "b.jsonl", "--log", "b.log")
        self.run_program("podm", "replay", "phantom:spheres@16", "b.log")
        guarantees = json.loads((self.folder / "b.jsonl").read_text())["guarantees"]
        self.assertEqual(set(guarantees.values()), {0})

    def test_pictures_and_pages_name_what_they_need(self):
        self.run_program("podm", "mesh", "phantom:spheres@16", "--radius", "5", "--quiet", "-o", "a.vtu")
        before = set(self.folder.iterdir())
        for words in (["view", "a.vtu", "-o", "a.png"],
                      ["mesh", "phantom:spheres@16", "--radius", "5", "-o", "b.vtu", "--report", "b.html"],
                      ["serve", "--no-browser"]):
            message = self.run_program("podm", *words, exit_code=2).stderr.strip()
            reason, *outcome = message.splitlines()
            self.assertIn("vtk", reason)
            self.assertEqual(outcome, ["podm: --report: the page could not be made"] * ("--report" in words), message)
        self.assertEqual(set(self.folder.iterdir()), before)

    def test_the_harness_runs_an_experiment(self):
        (self.folder / "small.toml").write_text(EXPERIMENT)
        self.run_program("podm-bench", "run", "small.toml")
        (row,) = map(json.loads, (self.folder / "results/runs/small.jsonl").read_text().splitlines())
        self.assertEqual(row["status"], "ok", row)
        self.assertEqual(row["verdicts"]["radius_edge"], "pass")

    def test_bad_input_is_refused(self):
        (self.folder / "a.nrrd").write_text("not an image")
        message = self.run_program("podm", "mesh", "a.nrrd", "-o", "a.vtu", exit_code=2).stderr
        self.assertIn("a.nrrd", message)

    @unittest.skipIf(WITHOUT_PACKAGE, "skipped: the programs only")
    def test_the_package_meshes_an_array_and_proves_the_mesh(self):
        import numpy
        import podm

        self.assertEqual(podm.__version__, os.environ["PODM_EXPECTED_VERSION"])
        image = numpy.frombuffer(cube(), dtype=numpy.uint8).reshape(16, 16, 16)
        for values in (image, image.astype(numpy.int64), numpy.asfortranarray(image, dtype=numpy.float32)):
            mesh = podm.mesh(values, radius=4)
            self.assertEqual(mesh.points.shape[1], 3)
            self.assertEqual(set(mesh.labels), {1})
            self.assertLess(mesh.quality()["radius_edge"].max(), 1.93)
        self.assertTrue(mesh.verify().holds, mesh.verify().text)
        with self.assertRaises(podm.Error):
            podm.mesh(numpy.zeros((4, 4, 4), dtype=int))


if __name__ == "__main__":
    unittest.main()
