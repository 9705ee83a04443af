"""podm mesh --thin keep: layers thinner than delta stay, and podm-verify proves the topology of each label."""

import json
import unittest

import numpy as np

from podm_process import PodmTestCase, run_podm
from slow import few
from small_images import write_nifti


def shells():
    """Cubes' shells of 1, 2 and 3 voxels, one in another; voxels[z, y, x]."""
    z, y, x = np.indices((26, 26, 26)) - 13
    r = np.maximum(np.maximum(abs(x), abs(y)), abs(z))
    return np.select([r == 11, (r == 7) | (r == 8), (r >= 2) & (r <= 4)], [1, 2, 3], 0)


def write_image(path, voxels):
    write_nifti(path, voxels.astype(np.uint8).tobytes(), voxels.shape[::-1])


class Thin(PodmTestCase):
    def setUp(self):
        super().setUp()
        self.image = self.folder / "shells.nii"
        write_image(self.image, shells())
        self.runs = self.folder / "runs.jsonl"

    def mesh(self, *arguments, image=None):
        return run_podm("mesh", image or self.image, "-o", self.folder / "out.vtu", "--record", self.runs,
                        "--radius", 6, "--delta", 3, *arguments)

    def record_of(self, *arguments):
        self.runs.unlink(missing_ok=True)
        self.assert_exit(self.mesh(*arguments), 0)
        return self.read_record(self.runs)

    def test_every_algorithm_keeps_shells_and_equals_its_replay(self):
        for algorithm in few((["podm", "--threads", 2], ["pdr", "--threads", 2], ["podm", "--executor", "virtual"],
                              ["podm-home", "--nodes", 2], ["pdr-podm", "--nodes", 2, "--cores-per-node", 1]), 2):
            log = self.folder / "run.log"
            record = self.record_of("--thin", "keep", "--algorithm", *algorithm, "--oversubscribe", "--log", log,
                                    "--verify")
            self.assertEqual(record["verdicts"]["topology"], "pass", algorithm)
            self.assertEqual(set(record["verdicts"].values()), {"pass"}, algorithm)
            self.assertEqual(set(record["guarantees"].values()), {0})
            self.assertEqual(record["thin_layers"]["differences"], [])
            self.assertEqual(record["thin_layers"]["components"], 3)
            self.assertIn("mend", record["phases_s"])
            self.assert_exit(run_podm("replay", self.image, log), 0)

    def test_a_mesh_that_loses_them_does_not_pass(self):
        self.assert_exit(self.mesh(), 0)
        verifier = run_podm("mesh", self.image, "-o", self.folder / "lost.vtu", "--radius", 6, "--delta", 3,
                            "--verify", "--thin", "lose")
        self.assert_exit(verifier, 0)  # it promises no topology
        self.assertNotIn("topology", verifier.stderr)

    def test_one_thread_makes_the_same_mesh_every_time(self):
        meshes = [self.record_of("--thin", "keep", "--threads", 1)["mesh_sha256"] for _ in range(2)]
        self.assertEqual(meshes[0], meshes[1])

    def test_what_differs_at_the_least_delta_is_listed_and_the_exit_code_is_1(self):
        # The floor allows what is thin, and no more than the first deltas: noise keeps differences.
        noise = self.folder / "noise.nii"
        write_image(noise, np.random.default_rng(3).integers(0, 3, (9, 9, 9)))
        process = self.mesh("--thin", "keep", "--delta-least", 0.7, image=noise)
        record = self.read_record(self.runs)
        listed = record["thin_layers"]["differences"]
        self.assertEqual(record["guarantees"]["topology"], len(listed))
        self.assert_exit(process, 1 if listed else 0)
        self.assertTrue((self.folder / "out.vtu").exists())
        for difference in listed:
            self.assertIn(f"{difference['kind']}", process.stderr)

    def test_the_plan_predicts_more_cells(self):
        def plan(*arguments):
            process = run_podm("info", self.image, "--plan", "--json", "--radius", 6, "--delta", 3, *arguments)
            self.assert_exit(process, 0)
            return json.loads(process.stdout)["plan"]
        lost, kept = plan(), plan("--thin", "keep")
        self.assertIsNone(lost["kept_layers"])
        self.assertGreater(kept["cells"], 2 * lost["cells"])
        self.assertAlmostEqual(kept["kept_layers"]["thinnest"]["thickness_mm"], 1, places=6)
        self.assertIn("kept", run_podm("info", self.image, "--plan", "--thin", "keep").stdout)

    def test_what_cannot_be_is_refused(self):
        output = ("mesh", self.image, "-o", self.folder / "out.vtu")
        self.assert_refused([*output, "--delta", 3, "--thin", "keep", "--delta-least", 1], "above 0.7 mm",
                            "voxel (3, 3, 2)")
        self.assert_refused([*output, "--delta", 3, "--thin", "keep", "--delta-least", 4], "delta-least", "3 mm")
        self.assert_refused([*output, "--delta-least", 0.5], "--thin")
        self.assert_refused([*output, "--thin", "keep", "--target-elements", 1000], "--target-elements")
        self.assert_refused([*output, "--thin", "maybe"], "keep", "lose")


if __name__ == "__main__":
    unittest.main()
