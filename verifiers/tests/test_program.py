"""podm-verify as a user runs it: exit codes, report, schema, bad input, the extracted cells."""

import json
import math
import os
import pathlib
import resource
import subprocess
import tempfile
import unittest
import zlib

import jsonschema
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

from inr_image import write_inr
from line_mutants import around_a_line, promising
from medit_mesh import kuhn_cubes
from mutants import REGULAR, tetrahedron

VERIFIER = os.environ["PODM_VERIFIER"]
SCHEMA = json.loads((pathlib.Path(__file__).parents[2] / "results/schema/podm-verify.schema.json").read_text())


def read_cell_arrays(path):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput().GetCellData()
    return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}


def meshed_voxels(voxels, becomes):
    """Returns six cells per voxel, centered on it. Their label is the voxel's or what it becomes; None makes no cell.
    """
    mesh = kuhn_cubes(*reversed(voxels.shape))
    labels = [becomes.get(label, label) for label in voxels.ravel()]
    mesh.cells = np.array([[*cell[:4], labels[c // 6]] for c, cell in enumerate(mesh.cells)
                           if labels[c // 6] is not None])
    return mesh


class ProgramTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.mesh = self.folder / "mesh.mesh"
        self.report = self.folder / "report.json"
        kuhn_cubes(3, 2, 2).write(self.mesh)

    def verify(self, *arguments, mesh=None, **options):
        return subprocess.run([VERIFIER, mesh or self.mesh, *map(str, arguments)], capture_output=True, text=True,
                              errors="surrogateescape", timeout=60, check=False, **options)

    def assert_exit(self, process, code):
        self.assertEqual(process.returncode, code, process.stdout + process.stderr)

    def read_report(self):
        report = json.loads(self.report.read_text())
        jsonschema.validate(report, SCHEMA)
        return report

    def test_a_sound_mesh_passes_every_claim_that_needs_nothing_else(self):
        process = self.verify("--json", self.report)
        self.assert_exit(process, 0)
        self.assertIn("left out: size (needs --radius), dihedral (needs --min-dihedral or --max-dihedral), "
                      "labels (needs --image), surface_vertices (needs --image), "
                      "box (needs --image, and --box flat or a file that promises it), "
                      "lines (needs --image and --lines-delta), fidelity (needs --image), "
                      "topology (needs --image, and a file that promises it)",
                      process.stdout)
        claims = self.read_report()["claims"]
        self.assertEqual({claim["verdict"] for claim in claims.values()}, {"pass"})
        self.assertNotIn("labels", claims)
        self.assertGreater(claims["delaunay"]["details"]["cospherical_facets"], 0)

    def test_a_claim_asked_for_without_its_input_is_not_run_and_fails(self):
        self.assert_exit(self.verify("--claims", "structure,labels,size", "--json", self.report), 1)
        claims = self.read_report()["claims"]
        self.assertEqual({name: claim["verdict"] for name, claim in claims.items()},
                         {"structure": "pass", "labels": "not_run", "size": "not_run"})

    def test_claims_that_rest_on_ids_are_not_run_on_a_mesh_without(self):
        mesh = tetrahedron(REGULAR)
        mesh.vertices[0, 0] = math.nan
        mesh.write(self.mesh)
        self.assert_exit(self.verify("--json", self.report), 1)
        claims = self.read_report()["claims"]
        self.assertEqual(claims.pop("structure")["verdict"], "fail")
        self.assertEqual({claim["verdict"] for claim in claims.values()}, {"not_run"})

    def test_the_worst_witness_is_named_and_extracted(self):
        mesh = kuhn_cubes(3, 2, 2)
        mesh.cells[7, [0, 1]] = mesh.cells[7, [1, 0]]
        mesh.write(self.mesh)
        bad = self.folder / "bad.vtu"
        process = self.verify("--json", self.report, "--extract-bad", bad)
        self.assert_exit(process, 1)
        self.assertIn("cells are positively oriented; cell 7", process.stdout)
        self.assertIn(7, [w["cells"][0] for w in self.read_report()["claims"]["structure"]["worst"]])
        failed = {name for name, claim in self.read_report()["claims"].items() if claim["verdict"] == "fail"}
        arrays = read_cell_arrays(bad)
        self.assertEqual(set(arrays), {"cell", "label", *failed})
        self.assertEqual(arrays["structure"][list(arrays["cell"]).index(7)], 1)
        self.assertLess(len(arrays["cell"]), len(mesh.cells))
        self.assertTrue((sum(arrays[claim] for claim in failed) >= 1).all(), "only cells in violation")
        self.assert_exit(self.verify("--claims", "structure", mesh=bad), 1)

    def test_an_option_that_may_be_repeated_takes_one_value_each_time(self):
        process = subprocess.run([VERIFIER, "--claims", "size", "--radius-of", "1=1", "--radius-of", "2=1", self.mesh],
                                 capture_output=True, text=True, timeout=60, check=False)
        self.assert_exit(process, 0)

    def test_a_left_handed_mesh_is_distinguished(self):
        mesh = kuhn_cubes(2, 1, 1)
        mesh.cells[:, [0, 1]] = mesh.cells[:, [1, 0]]
        mesh.write(self.mesh)
        process = self.verify("--claims", "structure")
        self.assert_exit(process, 1)
        self.assertIn("sound but left-handed", process.stdout)

    def test_results_do_not_depend_on_threads(self):
        reports = []
        for threads in 1, 3:
            self.verify("--json", self.report, "--threads", threads, "--radius", "0.5")
            claims = self.read_report()["claims"]
            for claim in claims.values():
                del claim["seconds"]
            reports.append(claims)
        self.assertEqual(*reports)

    def read_overlaps(self):
        """Returns Dice's coefficients of all labels between mesh and image."""
        return {row["dice"] for row in self.read_report()["claims"]["labels"]["details"]["labels"]}

    def test_a_mesh_of_some_labels_is_compared_with_those_of_the_image(self):
        voxels = np.random.default_rng(5).choice([0, 1, 2, 3, 7], size=(6, 7, 8))
        image = self.folder / "image.inr"
        write_inr(image, voxels, offset=0.5)
        for options, becomes in ((["--labels", "1-2,7"], {0: None, 3: None}),
                                 (["--drop", "2"], {0: None, 2: None}),
                                 (["--merge", "3,1=a", "--merge", "7,2=b"], {0: None, 1: 3, 2: 7}),
                                 (["--labels", "1-3", "--drop", "1", "--merge", "1,3=a"],
                                  {0: None, 1: None, 3: 1, 7: None}),
                                 (["--background", "7"], {7: None}),
                                 (["--background", "7", "--drop", "0"], {0: None, 7: None})):
            with self.subTest(options=options):
                meshed_voxels(voxels, becomes).write(self.mesh)
                claims = ["--claims", "labels,surface,fidelity", "--json", self.report, "--image", image]
                self.assert_exit(self.verify(*claims, *options), 0)
                self.assertEqual(self.read_overlaps(), {1})
                self.verify(*claims)
                self.assertNotEqual(self.read_overlaps(), {1}, "all labels of the image are other ones")

    def test_smoothing_is_as_the_option_says_or_else_the_file(self):
        voxels = np.zeros((8, 9, 10), dtype=np.uint8)
        voxels[2:6, 2:7, 2:7] = 1
        image = self.folder / "image.inr"
        write_inr(image, voxels, offset=0.5)
        mesh = meshed_voxels(voxels, {0: None})
        claims = ["--claims", "labels,fidelity", "--json", self.report, "--image", image]
        for comments, options, width in (([], [], None), ([], ["--smooth", "1.25"], 1.25),
                                         (["# promise smoothed 0.75\n"], [], 0.75),
                                         (["# promise smoothed 0.75\n"], ["--smooth", "1.25"], 1.25)):
            mesh.comments = comments
            mesh.write(self.mesh)
            process = self.verify(*claims, *options)
            self.assert_exit(process, 0)
            report = self.read_report()
            self.assertEqual(report["image"].get("smoothed_mm"), width)
            self.assertEqual(report["options"]["smooth_mm"], 1.25 if options else None)
            self.assertEqual(report["mesh"]["smoothing_mm"], 0.75 if comments else None)
            self.assertEqual("mesh_to_voxels" in report["claims"]["fidelity"]["details"], width is not None)
            line = f"image smoothed by {width} mm, as " + ("--smooth states" if options else "the mesh file states")
            self.assertEqual(line in process.stdout, width is not None, process.stdout)
        for width, fault in (("8.5", "image.inr: cannot be smoothed by 8.5 mm"), ("8", "less than 8 mm"),
                             ("0", "--smooth"), ("nan", "--smooth"), ("-1", "--smooth")):
            process = self.verify(*claims, "--smooth", width)
            self.assert_exit(process, 2)
            self.assertIn(fault, process.stderr)
        mesh.comments = ["# promise smoothed 20\n"]
        mesh.write(self.mesh)
        self.assert_exit(self.verify(*claims), 2)
        self.assert_exit(self.verify("--claims", "radius_edge"), 0)  # without the image nothing is smoothed

    def test_bounds_near_lines_are_those_of_a_mesh_that_keeps_lines(self):
        for promise, options, expected in (([], [], "fail"), ([], ["--lines-delta", 1], "pass"),
                                           (promising(1.5), [], "pass")):
            around_a_line(25, promise).write(self.mesh)
            process = self.verify("--claims", "boundary_angles,radius_edge", *options, "--json", self.report)
            claims = self.read_report()["claims"]
            self.assertEqual(claims["boundary_angles"]["verdict"], expected, process.stdout)
            for claim, items in (("boundary_angles", "facets"), ("radius_edge", "cells")):
                near = claims[claim]["details"].get("near_lines")
                self.assertEqual(near is not None and near[items] > 0, expected == "pass", claim)
                self.assertEqual(f"{items} near lines" in process.stdout, expected == "pass", process.stdout)

    def test_the_lines_of_a_mesh_are_compared_with_those_of_the_image(self):
        voxels = np.ones((4, 6, 6), dtype=int)
        voxels[:, :, 3:] = 2
        voxels[:, 3:, 3:] = 3
        write_inr(self.folder / "image.inr", voxels, offset=0.5)
        image = ["--image", self.folder / "image.inr"]
        mesh = meshed_voxels(voxels, {})
        for promise, options, expected in (([], [], None), ([], ["--lines-delta", 1], "pass"),
                                           (promising(1), [], "pass"), (promising(0.2), [], "fail"),
                                           (promising(0.2), ["--lines-delta", 1], "pass")):
            mesh.comments = promise
            mesh.write(self.mesh)
            process = self.verify(*image, *options, "--json", self.report)
            report = self.read_report()
            self.assertEqual(report["claims"].get("lines", {}).get("verdict"), expected, process.stdout)
            self.assertEqual("lines (needs --image and --lines-delta)" in process.stdout, expected is None)
            self.assertEqual(report["mesh"]["promised_lines_delta_mm"] is not None, promise != [])

    def test_sizes_near_interfaces_and_grades_are_those_of_the_labels_selected(self):
        voxels = np.ones((4, 4, 12), dtype=np.uint8)
        voxels[:, :, 6:9], voxels[:, :, 9:] = 2, 3
        image = self.folder / "image.inr"
        write_inr(image, voxels, offset=0.5)
        meshed_voxels(voxels, {}).write(self.mesh)  # circumradii sqrt(3) / 2; labels 1 and 2 meet at 6 mm
        size = ["--claims", "size", "--json", self.report, "--image", image]
        for options, num_over in ((["--size-near", "1,2=0.8:1"], 2 * 96),
                                  (["--size-near", "1,2=0.8"], 2 * 96),
                                  (["--size-near", "1,2=0.8:1.5"], 4 * 96),
                                  (["--size-near", "1,2=0.9:1.5"], 0),
                                  (["--size-near", "1,2=0.8:1", "--size-near", "3,2=0.8:1"], 4 * 96),
                                  (["--size-near", "1+3,2=0.8:1"], 4 * 96),
                                  (["--size-near", "1,2=0.8:1", "--merge", "2,3=both"], 2 * 96),
                                  (["--size-near", "1,0=0.8:1", "--drop", "2"], 6 * 96),
                                  (["--radius-of", "2=0.1", "--grade", "0.3"], 5 * 96),
                                  (["--radius-of", "2=0.1", "--grade", "9"], 3 * 96),
                                  (["--size-near", "1,2=0.1:0.5", "--grade", "0.2"], 4 * 96)):
            with self.subTest(options=options):
                process = self.verify(*size, *options)
                self.assert_exit(process, 1 if num_over else 0)
                claim = self.read_report()["claims"]["size"]
                self.assertEqual((claim["num_violations"], claim["num_checked"]), (num_over, 12 * 96))
                self.assertEqual("grade to within" in process.stdout, "--grade" in options)
                self.assertEqual(set(claim["details"]),
                                 {option[2:].replace("-", "_") for option in options[::2]} & {"size_near", "grade"})
        for near, fault in (("1,7=1", "no voxel has label 7"), ("1,1=1", "label 1 is on both sides"),
                            ("1,3=1", "no voxels of the two sides touch")):
            process = self.verify(*size, "--size-near", near)
            self.assert_exit(process, 2)
            self.assertIn(f"image.inr: --size-near {near}: {fault}", process.stderr)
        self.assert_exit(self.verify(*size, "--size-near", "1,2=9", "--space", "voxel"), 1)
        self.assertEqual(self.read_report()["claims"]["size"]["verdict"], "not_run")

    def test_a_meta_image_whose_header_states_an_old_stream_size_is_read_with_a_warning(self):
        voxels = np.random.default_rng(5).choice([1, 2], size=(6, 7, 8)).astype(np.uint8)
        meshed_voxels(voxels, {}).write(self.mesh)
        image = self.folder / "image.mha"
        stream = zlib.compress(voxels.tobytes())
        for size, num_warnings in (len(stream), 0), (7, 1):
            header = ("ObjectType = Image\nNDims = 3\nBinaryData = True\nCompressedData = True\n"
                      f"CompressedDataSize = {size}\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = -0.5 -0.5 0.5\n"
                      "DimSize = 8 7 6\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n")
            image.write_bytes(header.encode() + stream)
            options = ["--claims", "labels", "--image", image, "--space", "LPS", "--json", self.report]
            process = self.verify(*options)
            self.assertEqual(process.stdout.count("warning: "), num_warnings, process.stdout)
            self.assertEqual(len(self.read_report()["image"].get("warnings", [])), num_warnings)
        image.write_bytes(header.encode() + stream[:-5])
        process = self.verify(*options)
        self.assert_exit(process, 2)
        self.assertIn("image.mha: the file is truncated", process.stderr)

    def test_bad_usage_and_input_exit_with_two_and_name_the_fault(self):
        for arguments, fault in ((["--claims", "structure,delauny"], "no claim 'delauny', nearest is 'delaunay'"),
                                 (["--radius", "-1"], "--radius"),
                                 (["--radius", "nan"], "--radius"),
                                 (["--radius-edge", "inf"], "--radius-edge"),
                                 (["--angle", "nan"], "--angle"),
                                 (["--angle", "60.5"], "--angle"),
                                 (["--fidelity-voxels", "nan"], "--fidelity-voxels"),
                                 (["--vertex-voxels", "0"], "--vertex-voxels"),
                                 (["--delta", "0"], "--delta"),
                                 (["--radius-of", "3"], "LABEL=MM"),
                                 (["--radius-of", "3=inf"], "LABEL=MM"),
                                 (["--labels", "1"], "--image"),
                                 (["--smooth", "1"], "--image"),
                                 (["--grade", "1"], "--image"),
                                 (["--size-near", "1,2=1"], "--image"),
                                 (["--image", "absent.nii", "--grade", "0"], "--grade"),
                                 (["--image", "absent.nii", "--grade", "inf"], "--grade"),
                                 (["--image", "absent.nii", "--size-near", "1=2"], "--size-near: '1=2' is not"),
                                 (["--image", "absent.nii", "--size-near", "liver,0=2"], "'liver' is not a label"),
                                 (["--image", "absent.nii", "--size-near", "1,0=2:0"], "--size-near 1,0=2:0: '0'"),
                                 (["--image", "absent.nii", "--labels", "7-3"], "--labels: the range '7-3'"),
                                 (["--image", "absent.nii", "--merge", "2,3"], "--merge: '2,3' is not VALUES=NAME"),
                                 (["--background", "-1"], "--background"),
                                 (["--extract-bad", "x.txt"], ".vtu"),
                                 (["--image", self.folder / "absent.nii"], "absent.nii"),
                                 (["--schedule", self.folder / "absent.jsonl"], "absent.jsonl"),
                                 (["--json", self.folder / "absent" / "r.json"], "absent/r.json"),
                                 (["--unknown"], "--unknown")):
            process = self.verify(*arguments)
            self.assert_exit(process, 2)
            self.assertIn(fault, process.stderr)
        self.assert_exit(self.verify(mesh=self.folder / "absent.vtu"), 2)

    def test_a_report_does_not_replace_an_input(self):
        before = self.mesh.read_bytes()
        process = self.verify("--json", self.folder / "." / "mesh.mesh")
        self.assert_exit(process, 2)
        self.assertIn("is an input", process.stderr)
        self.assertEqual(self.mesh.read_bytes(), before)

    def test_a_pipe_is_written_to_and_stays_a_pipe(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        with subprocess.Popen(["cat", pipe], stdout=subprocess.PIPE) as reader:
            self.assert_exit(self.verify("--json", pipe), 0)
            jsonschema.validate(json.loads(reader.communicate(timeout=10)[0]), SCHEMA)
        self.assertTrue(pipe.is_fifo())

    def test_a_report_that_cannot_be_written_is_an_error(self):
        for arguments in [], ["--quiet", "--json", "-"]:
            with open("/dev/full", "wb") as full:
                process = subprocess.run([VERIFIER, self.mesh, *arguments], stdout=full, stderr=subprocess.PIPE,
                                         text=True, timeout=60, check=False)
            self.assertEqual(process.returncode, 2)
            self.assertIn("No space left on device", process.stderr)

    def test_a_report_past_a_limit_of_the_file_size_keeps_the_older_one(self):
        for name, arguments in (("report.json", ["--json"]), ("bad.vtu", ["--extract-bad"])):
            report = self.folder / name
            report.write_text("older")
            process = self.verify("--claims", "size", "--radius", 0.01, *arguments, report,
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1024, 1024)))
            self.assert_exit(process, 2)
            self.assertIn(f"{report}: cannot be written: File too large", process.stderr)
            self.assertEqual(report.read_text(), "older")
        self.assertEqual({path.name for path in self.folder.iterdir()}, {"mesh.mesh", "report.json", "bad.vtu"})

    def test_a_reader_that_is_gone_is_an_error(self):
        read_end, write_end = os.pipe()
        os.close(read_end)
        with open(write_end, "wb") as pipe:
            process = subprocess.run([VERIFIER, self.mesh, "--quiet", "--json", "-"], stdout=pipe, check=False,
                                     stderr=subprocess.PIPE, text=True, timeout=60)
        self.assertEqual(process.returncode, 2)
        self.assertIn("standard output: cannot be written: Broken pipe", process.stderr)

    def test_json_on_standard_output_is_alone_there(self):
        process = self.verify("--json", "-")
        self.assert_exit(process, 0)
        jsonschema.validate(json.loads(process.stdout), SCHEMA)
        self.assertIn("claims pass", process.stderr)

    def test_numbers_and_names_that_json_cannot_hold(self):
        flat = tetrahedron([(0, 0, 0), (1, 0, 0), (0, 1, 0), (3, 1, 0)])  # its circumradius is infinite
        flat.vertices[3, 2] = 0
        path = os.fsencode(self.folder) + b"/\xff.mesh"
        flat.write(path)
        self.assert_exit(self.verify("--json", self.report, "--radius", 1, mesh=path), 1)
        claims = self.read_report()["claims"]
        self.assertIsNone(claims["radius_edge"]["worst"][0]["value"])

    def test_faults_of_a_schedule_name_file_and_line(self):
        head = {"schema": "podm-schedule/1", "mesh_to_grid": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0],
                "leaves": [[0, 0, 0, 1]]}
        for lines, fault in (([{}], "line 1"),
                             ([{**head, "leaves": [[0, 0, 0, 3]]}], "power of two"),
                             ([head, {"leaf": 1}], "line 2"),
                             ([head, {"leaf": 0, "node": 0, "begin_s": 1, "end_s": 0}], "ends before it begins")):
            schedule = self.folder / "schedule.jsonl"
            schedule.write_text("\n".join(map(json.dumps, lines)))
            process = self.verify("--schedule", schedule)
            self.assert_exit(process, 2)
            self.assertIn("schedule.jsonl", process.stderr)
            self.assertIn(fault, process.stderr)


if __name__ == "__main__":
    unittest.main()
