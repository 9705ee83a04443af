"""podm info --plan: its predictions fit the run that follows and the image."""

import json
import unittest

import small_images
from podm_process import PodmTestCase, run_podm
from slow import few


class Plan(PodmTestCase):
    def plan(self, image, *options):
        process = run_podm("info", image, "--json", "--plan", *options)
        self.assert_exit(process, 0)
        return json.loads(process.stdout)

    def dumbbell(self):
        """Writes two cubes of label 1 that a rod of one voxel joins, a speck of label 2 and voxels of 2 mm."""
        def label_at(i, j, k):
            if (i, j, k) == (20, 4, 4):
                return 2
            is_cube = all(7 <= x <= 16 for x in (j, k)) and (1 <= i <= 8 or 15 <= i <= 22)
            return is_cube or (j == 11 and k == 12 and 8 < i < 15)
        return small_images.write_nifti(self.folder / "a.nii", small_images.voxels_of(24, label_at), (24,) * 3,
                                        affine=((2, 0, 0, 100), (0, 2, 0, 200), (0, 0, 2, 300)))

    def test_cells_and_memory_are_those_of_the_run(self):
        for options in few((("--radius", "2", "--delta", "1.3"), ("--target-elements", "60000")), 1):
            plan = self.plan("phantom:abdomen@64", *options, "--threads", "1")["plan"]
            process = run_podm("mesh", "phantom:abdomen@64", "-o", self.folder / "m.vtu", *options, "--threads", "1",
                               "--record", self.folder / f"{options[0]}.jsonl")
            self.assert_exit(process, 0)
            record = self.read_record(self.folder / f"{options[0]}.jsonl")
            self.assertAlmostEqual(plan["cells"] / record["cells"], 1, delta=0.15)
            self.assertAlmostEqual(plan["memory_bytes"] / record["peak_rss_bytes"], 1, delta=0.25)
            self.assertAlmostEqual(sum(label["cells"] for label in plan["labels"]) / plan["cells"], 1, delta=1e-3)
            self.assertAlmostEqual(sum(plan["phases_s"].values()), plan["seconds"], places=9)
            self.assertGreater(plan["phases_s"]["mesh"], 0)

    def test_sizes_are_those_that_the_run_uses(self):
        for options in (), ("--radius", "3"), ("--delta", "0.7"), ("--target-elements", "5000"):
            plan = self.plan("phantom:spheres@32", *options, "--threads", "1")["plan"]
            records = self.folder / f"{len(self.files())}.jsonl"
            run_podm("mesh", "phantom:spheres@32", "-o", self.folder / "m.vtu", *options, "--threads", "1",
                     "--record", records)
            record = self.read_record(records)
            if record["calibration"] is None or not record["calibration"]["meshes"]:
                self.assertEqual((plan["radius_mm"], plan["delta_mm"]),
                                 (record["used"]["radius_mm"], record["used"]["delta_mm"]))

    def test_thin_parts_are_where_they_are(self):
        plan = self.plan(self.dumbbell(), "--radius", "8", "--delta", "4")["plan"]
        by_kind = {kind: [part for part in plan["thin_parts"] if part["kind"] == kind]
                   for kind in ("whole", "bridge", "detail")}
        speck, = by_kind["whole"]
        self.assertEqual((speck["label"], speck["voxel"], speck["volume_mm3"]), (2, [20, 4, 4], 8))
        self.assertEqual(speck["place_mm"], [140, 208, 308])
        self.assertEqual(speck["thickness_mm"], 2)
        bridge, = by_kind["bridge"]
        self.assertEqual((bridge["label"], bridge["thickness_mm"]), (1, 2))
        self.assertEqual(bridge["voxel"][1:], [11, 12])
        self.assertEqual([part["kind"] for part in self.plan(self.dumbbell(), "--drop", "2", "--labels", "1")["plan"]
                          ["thin_parts"] if part["label"] == 2], [])

    def test_components_are_listed_by_label(self):
        info = self.plan(self.dumbbell(), "--radius", "8")
        for label, planned in zip(info["labels"], info["plan"]["labels"]):
            self.assertEqual(label["value"], planned["value"])
            self.assertAlmostEqual(sum(planned["components_mm3"]), label["volume_mm3"])
            self.assertEqual(planned["components_mm3"], sorted(planned["components_mm3"], reverse=True))
        self.assertEqual([len(planned["components_mm3"]) for planned in info["plan"]["labels"]], [1, 1])

    def test_text_has_the_same(self):
        process = run_podm("info", self.dumbbell(), "--plan", "--radius", "8", "--delta", "4")
        self.assert_exit(process, 0)
        for words in ("plan       radius 8 mm, delta 4 mm", "1 whole components, 1 bridges", "140 208 308"):
            self.assertIn(words, process.stdout)

    def test_absurdly_many_cells_are_reported_as_they_are(self):
        plan = self.plan(self.dumbbell(), "--radius", "1e-9")["plan"]
        for count in plan["cells"], plan["memory_bytes"], plan["labels"][0]["cells"]:
            self.assertGreater(count, 1e20)

    def test_a_target_takes_more_than_one_mesh(self):
        text = run_podm("info", self.dumbbell(), "--plan", "--target-elements", "20000").stdout
        self.assertIn("to find the radius", text)

    def test_options_need_a_plan_and_are_checked_as_those_of_a_run(self):
        image = self.dumbbell()
        self.assert_refused(["info", image, "--radius", "2"], "--radius", "--plan")
        for bad in "-1", "0", "nan":
            self.assert_refused(["info", image, "--plan", f"--delta={bad}"], "--delta", bad)
        self.assert_refused(["info", image, "--plan", "--delta", "1e6"], image, "longer than the image")
        self.assert_refused(["info", image, "--plan", "--radius-of", "7=2"], image, "no label '7'")
        self.assert_refused(["info", image, "--plan", "--min-dihedral", "80"], "dihedral")


if __name__ == "__main__":
    unittest.main()
