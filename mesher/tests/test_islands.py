"""--drop-islands: the result equals that of this test's own code, and programs with the same option agree."""

import collections
import json
import random
import unittest

import small_images
from podm_process import PodmTestCase, run_podm
from slow import few

SIZE = 10
SPACING = (1, 0.5, 2)  # a voxel of 1 mm^3, and faces of three sizes: 1, 2 and 0.5 mm^2
FACE_MM2 = (1, 2, 0.5)


def random_voxels(seed):
    """Returns slabs of labels 1 and 2 in background, with specks in, on and beside each other; by voxel."""
    rng = random.Random(seed)
    voxels = {(i, j, k): (1 + (i > 4)) * (1 < k < 8) for k in range(SIZE) for j in range(SIZE) for i in range(SIZE)}
    for _ in range(25):
        corner = [rng.randrange(SIZE) for _ in range(3)]
        label = rng.randrange(5)
        for voxel in list(voxels):
            if all(c <= x <= c + rng.randrange(2) for c, x in zip(corner, voxel)):
                voxels[voxel] = label
    return voxels


def neighbours(voxel):
    for axis in range(3):
        for step in -1, 1:
            yield axis, voxel[:axis] + (voxel[axis] + step,) + voxel[axis + 1:]


def components(voxels):
    """Yields the sets of voxels of one label, without the background."""
    left = {voxel for voxel, label in voxels.items() if label != 0}
    while left:
        found, todo = set(), [left.pop()]
        while todo:
            voxel = todo.pop()
            found.add(voxel)
            joined = {other for _, other in neighbours(voxel) if other in left and voxels[other] == voxels[voxel]}
            left -= joined
            todo += joined
        yield found


def dropped(voxels, below_mm3):
    voxels = dict(voxels)
    while islands := [found for found in components(voxels) if len(found) < below_mm3]:
        wet = set().union(*islands)
        becomes = {}
        for island in islands:
            area = collections.Counter()
            for voxel in island:
                for axis, other in neighbours(voxel):
                    if other not in wet:
                        area[voxels.get(other, 0)] += FACE_MM2[axis]
            if area:
                label = min(area, key=lambda of: (-area[of], of))
                becomes.update(dict.fromkeys(island, label))
        voxels.update(becomes)
    return voxels


class Islands(PodmTestCase):
    def image(self, voxels, name="a.nii"):
        ordered = [voxels[i, j, k] for k in range(SIZE) for j in range(SIZE) for i in range(SIZE)]
        rows = tuple(tuple(SPACING[row] * (row == column) for column in range(4)) for row in range(3))
        return small_images.write_nifti(self.folder / name, bytes(ordered), (SIZE,) * 3, affine=rows)

    def volumes(self, path, *options):
        process = run_podm("info", "--json", path, *options)
        self.assert_exit(process, 0)
        info = json.loads(process.stdout)
        return {label["value"]: label["voxels"] for label in info["labels"]}, info["warnings"]

    def test_what_is_left_equals_a_flood_by_other_code(self):
        for seed in few(range(25), 6):
            voxels = random_voxels(seed)
            path = self.image(voxels)
            for below_mm3 in 1.5, 4, 12:
                expected = dropped(voxels, below_mm3)
                counts = collections.Counter(label for label in expected.values() if label != 0)
                found, warnings = self.volumes(path, "--drop-islands", below_mm3)
                self.assertEqual(found, dict(counts), (seed, below_mm3))
                gone = set(voxels.values()) - set(expected.values()) - {0}
                self.assertEqual(len(warnings), len(gone))
                for label in gone:
                    self.assertTrue(any(f"label {label} is dropped entirely" in text for text in warnings))
                again = self.volumes(self.image(expected, "b.nii"), "--drop-islands", below_mm3)
                self.assertEqual(again, (dict(counts), []))

    def test_verifier_record_and_replay_are_of_the_same_image(self):
        for seed in range(3):
            voxels = random_voxels(seed)
            path, log, records = self.image(voxels), self.folder / "log", self.folder / f"runs{seed}.jsonl"
            options = "--drop-islands", "4"
            process = run_podm("mesh", path, "-o", self.folder / "m.vtu", "--delta", "0.7", *options, "--verify",
                               "--record", records, "--log", log)
            self.assert_exit(process, 0)
            record = self.read_record(records)
            self.assertEqual(record["options"]["labels"]["drop_islands_mm3"], 4)
            small = [found for found in components(voxels) if len(found) < 4]
            reported = {of["value"]: of for of in record["dropped_islands"]}
            self.assertEqual(set(reported), {voxels[min(found)] for found in small})
            self.assertGreaterEqual(sum(of["islands"] for of in reported.values()), len(small))
            self.assert_exit(run_podm("replay", path, log, *options), 0)
            self.assert_refused(["replay", path, log], "another image")

    def test_bad_volumes_are_refused(self):
        path = self.image(random_voxels(0))
        for bad in "-1", "0", "nan", "inf", "much":
            self.assert_refused(["mesh", path, "-o", self.folder / "m.vtu", f"--drop-islands={bad}"],
                                "--drop-islands", bad)
        self.assert_refused(["info", path, "--drop-islands", "1e9"], path, "no label has a component")


if __name__ == "__main__":
    unittest.main()
