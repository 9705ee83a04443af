"""podm mesh on a terminal."""

import os
import pty
import subprocess
import sys
import unittest

from podm_process import PROGRAM, PodmTestCase


class OnATerminal(PodmTestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        try:
            cls.terminal = pty.openpty()
        except OSError as error:
            print(f"skipped: no pseudo-terminal: {error}", file=sys.stderr)
            raise unittest.SkipTest("no pseudo-terminal") from error

    def test_a_bar_on_a_terminal_which_the_summary_does_not_share_a_line_with(self):
        ours, theirs = self.terminal
        process = subprocess.Popen([PROGRAM, "mesh", "phantom:spheres@24", "-o", str(self.folder / "out.vtu")],
                                   stderr=theirs, env={**os.environ, "TERM": "xterm"})
        os.close(theirs)
        text = b""
        try:
            while block := os.read(ours, 4096):
                text += block
        except OSError:  # the terminal's other end is closed
            pass
        os.close(ours)
        self.assertEqual(process.wait(), 0)
        self.assertRegex(text, rb"\r\x1b\[K\[#*\.*\] refine")
        self.assertRegex(text, rb"\r\x1b\[K[^\r\n]*out\.vtu: \d+ cells")


if __name__ == "__main__":
    unittest.main()
