"""podm mesh --size-image, --size-near and --grade: podm-verify proves the bounds; bad values are refused."""

import hashlib
import json
import os
import struct
import subprocess
import unittest

from podm_process import PROGRAM, PodmTestCase, run_podm
from slow import few
from small_images import FLOAT32, voxels_of, write_nifti

VERIFIER = os.path.join(os.path.dirname(PROGRAM), "podm-verify")
IMAGE = "phantom:spheres@48"


def write_sizes(path, size_at, voxels=9, step=30.0, datatype=FLOAT32):
    """Writes voxels `step` mm apart around the origin, with values size_at(x, y, z) in mm."""
    start = -step * (voxels - 1) / 2
    places = [start + step * i for i in range(voxels)]
    values = [float(size_at(x, y, z)) for z in places for y in places for x in places]
    affine = tuple(tuple(step * (row == axis) for axis in range(3)) + (start,) for row in range(3))
    write_nifti(path, struct.pack(f"<{len(values)}f", *values), (voxels,) * 3, datatype, affine)
    return path


class SizesByPlace(PodmTestCase):
    def setUp(self):
        super().setUp()
        self.mesh_path = self.folder / "out.vtu"
        self.runs = self.folder / "runs.jsonl"
        self.ramp = write_sizes(self.folder / "ramp.nii", lambda x, y, z: 8 + 0.05 * x)

    def record_of(self, *arguments, image=IMAGE, code=0):
        self.runs.unlink(missing_ok=True)
        process = run_podm("mesh", image, "-o", self.mesh_path, "--record", self.runs, *arguments)
        self.assert_exit(process, code)
        return self.read_record(self.runs)

    def verdict_on_size(self, *options):
        process = subprocess.run([VERIFIER, self.mesh_path, "--claims", "size", "--json", "-", "--quiet",
                                  *map(str, options)], capture_output=True, text=True, check=False)
        return json.loads(process.stdout)["claims"]["size"]

    def test_no_cell_is_over_its_place(self):
        for options in ((), ("--threads", 2), ("--algorithm", "pdr-podm", "--threads", 2), ("--algorithm", "pdr"),
                        ("--algorithm", "podm-home", "--threads", 2), ("--optimize", "--min-dihedral", 5),
                        ("--space", "LPS"), ("--grade", 0.04)):
            with self.subTest(options=options):
                record = self.record_of("--size-image", self.ramp, "--verify", "--oversubscribe", *options)
                self.assertEqual(record["verdicts"]["size"], "pass")
                claim = self.verdict_on_size("--size-image", self.ramp)
                self.assertEqual((claim["num_violations"], claim["num_checked"]), (0, record["cells"]))
                smaller = self.verdict_on_size("--size-image", self.ramp, "--size-factor", 0.8)
                self.assertGreater(smaller["num_violations"], 0)

    def test_the_record_has_them(self):
        record = self.record_of("--size-image", self.ramp, "--size-near", "shell,0=2", "--size-near", "2,1=1.5:3",
                                "--grade", 0.5)
        self.assertEqual(record["options"]["size_image"],
                         {"path": str(self.ramp), "sha256": hashlib.sha256(self.ramp.read_bytes()).hexdigest()})
        self.assertEqual(record["options"]["size_near"], [
            {"labels": [[1], [0]], "radius_mm": 2, "width_mm": 2},
            {"labels": [[2], [1]], "radius_mm": 1.5, "width_mm": 3}])
        self.assertEqual(record["options"]["grade"], 0.5)
        self.assertEqual(record["used"]["size_image_factor"], 1)
        plain = self.record_of("--radius", 9)
        self.assertEqual([plain["options"][key] for key in ("size_image", "size_near", "grade")], [None, [], 0])

    def test_constant_sizes_are_a_radius(self):
        constant = write_sizes(self.folder / "constant.nii", lambda x, y, z: 7)
        by_image, by_radius = self.record_of("--size-image", constant), self.record_of("--radius", 7)
        self.assertEqual(by_image["used"]["delta_mm"], by_radius["used"]["delta_mm"])
        self.assertLess(abs(by_image["cells"] / by_radius["cells"] - 1), 0.03)

    def test_one_thread_makes_the_same_mesh_and_the_log_of_many_makes_theirs(self):
        options = ("--size-image", self.ramp, "--size-near", "1,0=3", "--grade", 0.3, "--threads")
        first = self.record_of(*options, 1)
        self.assertEqual(self.record_of(*options, 1)["mesh_sha256"], first["mesh_sha256"])
        log = self.folder / "run.log"
        for more in ((), ("--algorithm", "pdr-podm")):
            parallel = self.record_of(*options, 2, "--oversubscribe", "--log", log, *more)
            replayed = run_podm("replay", IMAGE, log)
            self.assert_exit(replayed, 0)
            self.assertIn(parallel["mesh_sha256"], replayed.stdout + replayed.stderr)

    def test_a_target_scales_them(self):
        record = self.record_of("--size-image", self.ramp, "--target-elements", 20000, "--verify")
        self.assertLess(abs(record["cells"] / 20000 - 1), 0.05)
        factor = record["used"]["size_image_factor"]
        self.assertNotEqual(factor, 1)
        self.assertEqual(record["verdicts"]["size"], "pass")
        self.assertEqual(self.verdict_on_size("--size-image", self.ramp, "--size-factor", factor)["verdict"], "pass")

    def test_cells_are_small_near_an_interface(self):
        near = ("--size-near", "core,shell=2:3")
        records = [self.record_of("--radius", 9, *more) for more in ((), near, (*near, "--grade", 0.2))]
        plain, sharp, graded = ({label["name"]: label["cells"] for label in record["labels"]} for record in records)
        self.assertGreater(sharp["core"], 3 * plain["core"])
        self.assertGreater(graded["core"], sharp["core"])
        self.assertLess(sharp["neighbour"], 1.2 * plain["neighbour"], "the core is not beside it")

    def test_no_cell_is_over_its_bound_near_an_interface_or_over_its_grade(self):
        near = ("--radius", 14, "--size-near", "core,shell=2:5", "--size-near", "neighbour,0=3", "--grade", 0.15)
        for options in few((("--algorithm", "pdr-podm", "--threads", 2), ("--optimize",), ("--size-image", self.ramp),
                            (), ("--threads", 2), ("--space", "LPS"), ("--smooth", 6), ("--radius-of", "neighbour=4")),
                           3):
            with self.subTest(options=options):
                record = self.record_of(*near, "--verify", "--oversubscribe", *options)
                self.assertEqual(record["verdicts"]["size"], "pass")
        image = self.folder / "spheres.nii"
        self.assert_exit(run_podm("phantom", "spheres", "--size", 48, "-o", image), 0)
        record = self.record_of(*near)
        for radius, width, grade, verdict in ((2, 5, 0.15, "pass"), (1.9, 5, 0.15, "fail"), (2, 9, 0.15, "fail"),
                                              (2, 5, 0.05, "fail")):
            claim = self.verdict_on_size("--image", image, "--radius", 14, "--size-near", f"2,1={radius}:{width}",
                                         "--size-near", "3,0=3", "--grade", grade)
            self.assertEqual((claim["verdict"], claim["num_checked"]), (verdict, record["cells"]))

    def test_bounds_hold_beyond_the_image_where_an_object_is_cut_off(self):
        ball = voxels_of(20, lambda i, j, k: (i - 3) ** 2 + j ** 2 + k ** 2 < 225)
        image = write_nifti(self.folder / "cut.nii", ball, (20,) * 3)
        for options in ((), ("--optimize", "--min-dihedral", 8)):
            record = self.record_of("--radius", 4, "--size-near", "1,0=1:3", "--grade", 0.3, "--verify", *options,
                                    image=image)
            self.assertEqual(record["verdicts"]["size"], "pass", options)

    def test_labels_near_which_sizes_hold_reach_the_verifier_by_their_values(self):
        image, names = self.folder / "slabs.nii", self.folder / "names.txt"
        write_nifti(image, voxels_of(12, lambda i, j, k: [2, 0, 3, 1][i // 3] if 1 < j < 10 and 1 < k < 10 else 1))
        names.write_text("2 slab\n3 slab\n0 gap\n")
        for near, labels in (("slab,gap=0.5:1", "2+3,1"), ("gap,1=0.5:1", "1,0"), ("2,1=0.5:1", "2,0")):
            with self.subTest(near=near):
                record = self.record_of("--background", 1, "--label-names", names, "--radius", 3, "--size-near", near,
                                        "--verify", image=image)
                self.assertEqual(record["verdicts"]["size"], "pass")
                for bounds, verdict in ("0.5:1", "pass"), ("0.45:1", "fail"), ("0.5:3", "fail"):
                    claim = self.verdict_on_size("--image", image, "--background", 1,
                                                 "--size-near", f"{labels}={bounds}")
                    self.assertEqual(claim["verdict"], verdict, bounds)

    def refused(self, *options):
        return ("mesh", IMAGE, "-o", self.mesh_path, *options)

    def test_bad_files_are_refused(self):
        far = write_sizes(self.folder / "far.nii", lambda x, y, z: 5, step=0.001)
        far.write_bytes(far.read_bytes()[:292] + struct.pack("<f", 9000) + far.read_bytes()[296:])
        self.assert_refused(self.refused("--size-image", far), far, "do not overlap")
        nan = write_sizes(self.folder / "nan.nii", lambda x, y, z: float("nan") if x > 100 and y > 100 else 5)
        self.assert_refused(self.refused("--size-image", nan), nan, "voxel (8, 8, 0) is not a number")
        none = write_sizes(self.folder / "none.nii", lambda x, y, z: -1)
        self.assert_refused(self.refused("--size-image", none), none, "no voxel has a size above 0")
        flat = write_nifti(self.folder / "flat.nii", bytes(4 * 9), (3, 3), FLOAT32) or self.folder / "flat.nii"
        self.assert_refused(self.refused("--size-image", flat), flat, "a 3-D image is needed")
        self.assert_refused(self.refused("--size-image", self.folder / "absent.nii"), "absent.nii", "no such file")

    def test_bad_options_are_refused(self):
        for grade in "0", "-1", "nan", "steep":
            self.assert_refused(self.refused("--radius", 9, f"--grade={grade}"), "--grade", grade)
        for near in "1=2", "1,2", ",1=2", "1,=2", "1,2=0", "1,2=-1", "1,2=1:0", "1,2=x", "1,2=1:":
            self.assert_refused(self.refused("--size-near", near), "--size-near")
        self.assert_refused(self.refused("--size-near", "1,1=2"), "phantom:",
                            "labels 1 and 1: label 1 is on both sides")
        self.assert_refused(self.refused("--size-near", "1,9=2"), "no label '9'")
        for option, value in (("--size-image", self.ramp), ("--size-near", "1,0=2"), ("--grade", 0.5)):
            self.assert_refused(self.refused(option, value, "--space", "voxel", "--verify"),
                                f"podm-verify does not check the sizes of {option} in --space voxel")


if __name__ == "__main__":
    unittest.main()
