"""Outputs on a disk that fills give exit code 2 and a message that names the file and the fault. Older files stay
unchanged, and no new file is left behind."""

import io
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tarfile
import unittest

import small_images
from podm_process import PROGRAM, TIMEOUT_S, PodmTestCase, run_podm

BALL = small_images.ball_voxels(12)
# Options that add an output to those of `podm mesh IMAGE`, and the name of the output.
OUTPUTS = [*((["-o", f"out.{extension}"], f"out.{extension}") for extension in ("vtu", "mesh", "msh")),
           (["-o", "out.xdmf"], "out.h5"),
           *((["--surface", f"s.{extension}"], f"s_1.{extension}") for extension in ("stl", "ply")),
           (["--log", "run.log"], "run.log"),
           (["--algorithm", "pdr", "--leaf-size", "1", "--schedule", "leaves.jsonl"], "leaves.jsonl"),
           (["--record", "runs.jsonl"], "runs.jsonl")]


def file_size_limit(size):
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


class FileSizeLimit(PodmTestCase):
    """No file can grow past a limit of the process."""

    def setUp(self):
        super().setUp()
        self.image = small_images.write_nifti(self.folder / "ball.nii", BALL)

    def test_meshes_and_images(self):
        (self.folder / "out.mesh").write_text("older")
        for name in "out.vtu", "out.mesh", "out.msh":
            with self.subTest(name=name):
                self.assert_refused(["mesh", self.image, "--quiet", "-o", self.folder / name],
                                    f"cannot write {self.folder}/{name}: File too large",
                                    preexec_fn=file_size_limit(4096))
        for name in "p.nii", "p.nii.gz":
            self.assert_refused(["phantom", "abdomen", "--size", "64", "-o", self.folder / name], name,
                                "File too large", preexec_fn=file_size_limit(2048))

    def test_a_record_that_does_not_fit_is_not_cut(self):
        limit = 1 << 20  # the mesh fits, the line does not
        record = self.folder / "runs.jsonl"
        for before in b"x" * (limit - 20) + b"\n", b"x" * limit:
            record.write_bytes(before)
            process = run_podm("mesh", self.image, "-o", self.folder / "out.mesh", "--record", record,
                               preexec_fn=file_size_limit(limit))
            self.assert_exit(process, 2)
            self.assertIn("runs.jsonl", process.stderr)
            self.assertEqual(record.read_bytes(), before)


# Makes the working folder, in a mount namespace of its own, a disk of 1 MiB with the older files $NAMES and $ROOM free
# bytes. Then runs the command. The exit code and an archive of the disk go to a folder beside the disk.
ON_A_SMALL_DISK = """
mount -t tmpfs -o size=1m podm_test . && cd "$PWD" || exit 99
for name in $NAMES; do printf "%4090s\\n" "older $name" > $name; done  # a page
head -c 2m /dev/zero > filler 2> ../outcome/filling
truncate -s -$ROOM filler
"$@" > ../outcome/stdout 2> ../outcome/stderr
echo $? > ../outcome/code
rm filler
tar -c . > ../outcome/disk.tar
"""


class SmallDisk(PodmTestCase):
    """A file system with few bytes free."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.unshare = ["unshare", "--mount"] + ["--user", "--map-root-user"] * (os.geteuid() != 0)
        try:
            subprocess.run([*cls.unshare, "mount", "-t", "tmpfs", "podm_test", "/mnt"], check=True,
                           capture_output=True, text=True)
        except (OSError, subprocess.CalledProcessError) as error:
            print("skipped: no disk can be mounted:", getattr(error, "stderr", None) or error, file=sys.stderr)
            raise unittest.SkipTest("no disk can be mounted") from error

    def setUp(self):
        super().setUp()
        self.image = small_images.write_nifti(self.folder / "ball.nii", BALL)

    def assert_refused_on_a_disk_with(self, room, names, arguments, refused):
        disk, outcome = self.folder / "disk", self.folder / "outcome"
        for folder in disk, outcome:
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
        process = subprocess.run([*self.unshare, "sh", "-c", ON_A_SMALL_DISK, "sh", PROGRAM, *map(str, arguments)],
                                 cwd=disk, env={**os.environ, "NAMES": " ".join(names), "ROOM": str(room)},
                                 capture_output=True, text=True, timeout=TIMEOUT_S)
        self.assertEqual(process.returncode, 0, process.stderr)
        stderr = (outcome / "stderr").read_text()
        self.assertEqual((outcome / "code").read_text(), "2\n", stderr)
        self.assertIn(f"cannot write {refused}: No space left on device", stderr)
        with tarfile.open(fileobj=io.BytesIO((outcome / "disk.tar").read_bytes())) as archive:
            left = {pathlib.Path(member.name).name: archive.extractfile(member).read().decode()
                    for member in archive if member.isfile()}
        self.assertEqual(left, {name: f"{'older ' + name:>4090}\n" for name in names})

    def test_every_output_keeps_the_older_file(self):
        for options, name in OUTPUTS:
            mesh = [] if "-o" in options else ["-o", self.folder / "mesh.vtu"]
            names = {"out.vtu": ["out.vtu", "out_facets.vtu"], "out.h5": ["out.xdmf", "out.h5"]}.get(name, [name])
            for room in 0, 4096:
                if room > 0 and name == "runs.jsonl":
                    continue  # a line is shorter
                with self.subTest(name=name, room=room):
                    self.assert_refused_on_a_disk_with(
                        room, names, ["mesh", self.image, "--quiet", *mesh, *options], name)
        for name in "p.nii", "p.nii.gz":
            self.assert_refused_on_a_disk_with(2048, [name], ["phantom", "abdomen", "--size", "64", "-o", name], name)

    def test_a_record_that_is_new_is_not_left_empty(self):
        self.assert_refused_on_a_disk_with(0, [], ["mesh", self.image, "--quiet", "-o", self.folder / "mesh.vtu",
                                                   "--record", "runs.jsonl"], "runs.jsonl")


if __name__ == "__main__":
    unittest.main()
