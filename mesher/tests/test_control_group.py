"""podm mesh in a control group with a memory limit, nested in a group without a limit."""

import os
import pathlib
import sys
import unittest

import small_images
from podm_process import PodmTestCase, run_podm
from test_memory import TOO_FEW

LIMIT_BYTES = 100 * 2 ** 20


def own_folder():
    """Returns the memory folder of this process's group, and True for version 1; None if it cannot be found."""
    for line in pathlib.Path("/proc/self/cgroup").read_text().splitlines():
        _, controllers, path = line.split(":", 2)
        for root, legacy in (("/sys/fs/cgroup/memory", True), ("/sys/fs/cgroup", False)):
            folder = pathlib.Path(root + path)
            has_memory = controllers == "memory" if legacy else controllers == ""
            if has_memory and (folder / ("memory.limit_in_bytes" if legacy else "memory.max")).exists():
                return folder, legacy
    return None


class InAControlGroup(PodmTestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.groups = []
        cls.addClassCleanup(lambda: [group.rmdir() for group in reversed(cls.groups)])
        try:
            folder, legacy = own_folder()
            for name in (f"podm-test-{os.getpid()}", "inner"):
                folder = folder / name
                folder.mkdir()
                cls.groups.append(folder)
            outer = folder.parent
            (outer / ("memory.limit_in_bytes" if legacy else "memory.max")).write_text(str(LIMIT_BYTES))
        except (OSError, TypeError) as error:
            print(f"skipped: no control group can be made: {error}", file=sys.stderr)
            raise unittest.SkipTest("no control group") from error

    def test_the_limit_of_the_group_around_ends_the_run_before_the_kernel_does(self):
        self.check(small_images.ball_voxels(40), 40, "--verify")

    # The voxels and the transform of the image take 56 MB of the 84 MB that are granted.
    def test_an_image_is_counted_once(self):
        self.check(bytes([1]) * 210 ** 3, 210)

    def check(self, voxels, size, *options):
        image = small_images.write_nifti(self.folder / "image.nii", voxels, (size,) * 3)
        procs = self.groups[-1] / "cgroup.procs"
        process = run_podm("mesh", image, *TOO_FEW, "-o", self.folder / "out.vtu", "--quiet", *options,
                           preexec_fn=lambda: procs.write_text(str(os.getpid())))
        self.assert_exit(process, 1)
        self.assertIn("memory limit", process.stderr)
        self.assertTrue((self.folder / "out.vtu").exists())


if __name__ == "__main__":
    unittest.main()
