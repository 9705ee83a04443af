"""podm mesh --optimize: its improvements, the bounds that it keeps, the promises in its files, and its refusals."""

import json
import os
import subprocess
import unittest

from podm_process import PROGRAM, PodmTestCase, run_podm
from slow import few

VERIFIER = os.path.join(os.path.dirname(PROGRAM), "podm-verify")


class Optimize(PodmTestCase):
    def setUp(self):
        super().setUp()
        self.runs = self.folder / "runs.jsonl"

    def mesh(self, *arguments, name="out.mesh", image="phantom:abdomen@64"):
        return run_podm("mesh", image, "-o", self.folder / name, "--record", self.runs, *arguments)

    def record_of(self, *arguments, code=0, **more):
        self.runs.unlink(missing_ok=True)
        self.assert_exit(self.mesh(*arguments, **more), code)
        return self.read_record(self.runs)

    def verdicts(self, name, *options):
        report = self.folder / "report.json"
        process = subprocess.run([VERIFIER, self.folder / name, "--json", report, *options], capture_output=True,
                                 text=True, check=False)
        return process, json.loads(report.read_text())

    def test_worst_cells_get_better_and_all_else_stays(self):
        before = self.record_of("--radius", "8")
        for threads in few((3, 1), 1):
            after = self.record_of("--radius", "8", "--optimize", "--verify", "--threads", threads, "--oversubscribe")
            self.assert_valid_mesh(self.folder / "out.mesh")
            done = after["optimization"]
            self.assertGreater(done["beyond_bounds_before"], 50)
            self.assertLess(done["beyond_bounds"], done["beyond_bounds_before"] / 50)
            self.assertEqual(sum(done["obstacles"].values()), done["beyond_bounds"])
            self.assertEqual(set(after["guarantees"].values()), {0})
            self.assertNotIn("delaunay", after["verdicts"])
            self.assertEqual(set(after["verdicts"].values()), {"pass"})
            self.assertEqual(after["verdicts"].get("dihedral"), "pass" if after["promised_dihedral_deg"] else None)
            self.assertLessEqual(set(after["verdicts"]), set(after["promises"]))
            self.assertAlmostEqual(after["cells"] / before["cells"], 1, delta=0.05)
        self.assertIsNone(before["optimization"])
        self.assertNotIn("promises", before)
        self.assertIsNone(before["options"]["optimize"])

    def test_volumes_and_surfaces_stay_but_for_peels(self):
        before, after = self.record_of("--radius", "8"), self.record_of("--radius", "8", "--optimize")
        peels = after["optimization"]["successes"]["peels"]
        self.assertAlmostEqual(after["boundary_facets"], before["boundary_facets"], delta=4 * peels)
        for one, other in zip(before["labels"], after["labels"]):
            self.assertAlmostEqual(one["volume_mm3"] / other["volume_mm3"], 1, delta=1e-12 if peels == 0 else 1e-3)

    def test_it_is_a_phase_of_its_own_outside_of_the_speeds(self):
        record = self.record_of("--radius", "8", "--optimize")
        phases = record["phases_s"]
        self.assertGreater(phases["optimize"], 0)
        counted = set(phases) - {"draw", "optimize", "measure", "write"}
        seconds = sum(phases[phase] for phase in counted)
        self.assertAlmostEqual(record["cells_per_second"] * seconds / record["cells"], 1, places=6)

    def test_one_thread_makes_the_same_mesh_every_time(self):
        hashes = {self.record_of("--radius", "8", "--optimize", "--threads", "1")["mesh_sha256"] for _ in range(2)}
        self.assertEqual(len(hashes), 1)
        self.assertNotIn(self.record_of("--radius", "8", "--threads", "1")["mesh_sha256"], hashes)

    def test_files_of_each_format_say_what_they_do_not_claim(self):
        for name in "out.vtu", "out.mesh", "out.msh":
            with self.subTest(name=name):
                record = self.record_of("--radius", "3.5", "--optimize", name=name, image="phantom:spheres@32")
                self.assertEqual(record["promised_dihedral_deg"], [8, 165])
                process, report = self.verdicts(name)
                self.assertEqual(process.returncode, 0, process.stdout)
                self.assertIn("delaunay (the file does not claim it)", process.stdout)
                self.assertEqual(report["mesh"]["unclaimed"], ["delaunay"])
                self.assertEqual(report["mesh"]["promised_dihedral_deg"], [8, 165])
                self.assertEqual(report["claims"]["dihedral"]["verdict"], "pass")
                process, report = self.verdicts(name, "--claims", "delaunay")
                self.assertEqual(report["claims"]["delaunay"]["verdict"], "fail")  # an explicit claim is checked
        self.assert_exit(self.mesh("--radius", "6", image="phantom:spheres@32"), 0)
        self.assertEqual(self.verdicts("out.mesh")[1]["mesh"]["unclaimed"], [])

    def test_bounds_that_cells_miss_are_counted_and_not_promised(self):
        record = self.record_of("--radius", "8", "--optimize", "--dihedral-bounds", "12,155", "--verify")
        done = record["optimization"]
        self.assertGreater(done["beyond_bounds"], 0)
        self.assertIsNone(record["promised_dihedral_deg"])
        self.assertNotIn("dihedral", record["verdicts"])
        process, report = self.verdicts("out.mesh", "--claims", "dihedral", "--min-dihedral", "12", "--max-dihedral",
                                        "155", "--extract-bad", self.folder / "bad.vtu")
        self.assertEqual(process.returncode, 1)
        self.assertEqual(report["claims"]["dihedral"]["num_violations"], done["beyond_bounds"])
        self.assertTrue((self.folder / "bad.vtu").exists())

    def test_a_run_that_ends_early_writes_a_sound_mesh(self):
        record = self.record_of("--radius", "2", "--optimize", "--max-seconds", "0.5", code=1,
                                image="phantom:abdomen@96")
        self.assertEqual((record["stop_reason"], record["optimization"]), ("time limit", None))
        process, _ = self.verdicts("out.mesh", "--claims", "structure,surface")
        self.assertEqual(process.returncode, 0, process.stdout)

    def test_the_summary_lists_what_was_done(self):
        text = self.mesh("--radius", "8", "--optimize").stderr
        self.assertRegex(text, r"optimized +\d+ cells below 8 or above 165 deg, \d+ before")
        self.assertRegex(text, r"by \d+ flips")

    def test_senseless_options_are_refused(self):
        target = ["mesh", "phantom:spheres@24", "-o", self.folder / "x.mesh"]
        self.assert_refused([*target, "--dihedral-bounds", "8,165"], "--dihedral-bounds", "--optimize")
        for bounds in "16,165", "8,149", "0,165", "8,180", "8", "8,x":
            self.assert_refused([*target, "--optimize", "--dihedral-bounds", bounds])
        self.assert_refused([*target, "--optimize", "--log", self.folder / "run.log"], "log")


if __name__ == "__main__":
    unittest.main()
