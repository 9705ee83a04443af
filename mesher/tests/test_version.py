"""The version has one source, project() of CMakeLists.txt: all places that print it agree."""

import pathlib
import re
import unittest

from podm_process import run_podm

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Version(unittest.TestCase):
    def test_all_report_that_of_the_project(self):
        version = re.search(r"project\(podm VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
        self.assertEqual(run_podm("--version").stdout.splitlines()[0], f"podm {version}")
        cited = re.search(r"^version: (.*)$", (ROOT / "CITATION.cff").read_text(), re.MULTILINE).group(1)
        self.assertEqual(cited, version)
        newest = re.search(r"^## (\S+?),", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE).group(1)
        self.assertEqual(newest, version)


if __name__ == "__main__":
    unittest.main()
