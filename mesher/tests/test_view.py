"""podm view: pictures of meshes in every format that it reads."""

import pathlib
import signal
import struct
import subprocess
import sys
import time
import unittest

from ending_podm import end_of
from podm_process import PodmTestCase, run_podm, start_podm
from slow import few, slow

NEEDED = [pathlib.Path("/usr/bin/Xvfb"), pathlib.Path("/usr/lib/python3/dist-packages/vtkmodules")]


def setUpModule():
    if not all(path.exists() for path in NEEDED):
        print("skipped: xvfb or python3-vtk9 is not installed", file=sys.stderr)
        raise unittest.SkipTest("not installed")


def processes_of_session(session):
    """Returns state, processor seconds and name of the running processes of the session, without zombies."""
    listing = subprocess.run(["ps", "-o", "stat=,cputimes=,comm=", "-s", str(session)], capture_output=True,
                             text=True).stdout
    return [line for line in listing.splitlines() if not line.startswith("Z")]


class View(PodmTestCase):
    def mesh(self, name):
        path = self.folder / name
        process = run_podm("mesh", "phantom:spheres@24", "--radius", "5", "--threads", "1", "--quiet", "-o", path)
        self.assert_exit(process, 0)
        return path

    @slow
    def test_all_formats_give_the_same_picture(self):
        pictures = []
        for name in ("a.vtu", "a.vtk", "a.msh", "a.ele"):
            picture = self.folder / (name + ".png")
            process = run_podm("view", self.mesh(name), "-o", picture, "--size", "200x100", "--cut", "z=-1mm")
            self.assert_exit(process, 0)
            self.assertEqual(process.stdout + process.stderr, "")
            pictures.append(picture.read_bytes())
        self.assertEqual(pictures[0][:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(struct.unpack(">II", pictures[0][16:24]), (200, 100))
        self.assertEqual(len(set(pictures)), 1)
        self.assertEqual({path.suffix for path in self.folder.iterdir()},
                         {".vtu", ".vtk", ".msh", ".node", ".ele", ".face", ".png"})

    def test_what_is_asked_for_changes_the_picture(self):
        mesh, pictures = self.mesh("a.vtu"), []
        for arguments in few(([], ["--cut", "1,1,0=0.3"], ["--hide", "2"], ["--camera", "60,-20"], ["--flip"],
                              ["--cut", "none"], ["--colour", "size"], ["--zoom", "2"], ["--background", "#123456"],
                              ["--no-legend"]), 4):
            self.assert_exit(run_podm("view", mesh, "-o", self.folder / "a.png", "--size", "160x120", *arguments), 0)
            pictures.append((self.folder / "a.png").read_bytes())
        self.assertEqual(len(set(pictures)), len(pictures))

    def test_a_signal_leaves_no_display_and_no_picture(self):
        mesh, before = self.mesh("a.vtu"), self.files()
        for wait_s in (0.1, 0.5, 1):
            process = start_podm("view", mesh, "-o", self.folder / "a.png", "--size", "4000x4000",
                                 start_new_session=True)
            time.sleep(wait_s)
            self.assertEqual(end_of(process, signal.SIGTERM).code, -signal.SIGTERM)
            ended_s = time.monotonic()
            while left := processes_of_session(process.pid):
                self.assertLess(time.monotonic() - ended_s, 60, left)  # a busy machine took more than 5 s
                time.sleep(0.05)
            self.assertEqual(self.files(), before)

    def test_bad_words_are_refused_before_anything_is_read(self):
        out = ["view", self.folder / "none.vtu", "-o", self.folder / "a.png"]
        for option, values in {"--cut": ["0.5", "w=0.5", "x=2", "x=nanmm", "0,0,0=0.5", "1,2=0.5", "x="],
                               "--size": ["100", "0x10", "10x20x30", "99999x10"], "--background": ["red", "#12345g"],
                               "--camera": ["1", "1,2,3", "inf,0"], "--zoom": ["0", "-1"], "--labels": ["", "a,,b"],
                               "--colour": ["angle"]}.items():
            for value in values:
                with self.subTest(option=option, value=value):
                    self.assert_refused([*out, f"{option}={value}"], option)
        self.assert_refused(["view", "a.vtu", "-o", self.folder / "a.jpg"], "a.jpg", ".png")

    def test_what_cannot_be_shown_is_named(self):
        mesh = self.mesh("a.vtu")
        out = ["-o", self.folder / "a.png"]
        self.assert_refused(["view", self.folder / "none.vtu", *out], "podm:", "none.vtu", "No such file")
        self.assert_refused(["view", self.folder / "a_facets.vtu", *out], "a_facets.vtu", "label")
        self.assert_refused(["view", mesh, *out, "--labels", "9"], "--labels", "'9'")
        self.assert_refused(["view", mesh, *out, "--cut", "x=1e6mm", "--flip"], "--cut", "--flip")
        self.assert_refused(["view", mesh, "-o", self.folder / "none" / "a.png"], "cannot write", "none/a.png")
        (self.folder / "broken.vtu").write_bytes(mesh.read_bytes()[:2000])
        self.assert_refused(["view", self.folder / "broken.vtu", *out], "broken.vtu")


if __name__ == "__main__":
    unittest.main()
