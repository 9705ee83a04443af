"""The documentation of this tree: its commands run in the order of each page, and its links lead somewhere."""
import os
import tempfile
import unittest
from pathlib import Path

import paths
from docs.audit import pages_of
from website.blocks import run_page
from website.links import faults_of_links

ROOT = paths.SCRIPTS.parent
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
BUILD = Path(os.environ.get("PODM_BUILD", ROOT / "build"))
# Open MPI refuses to start as root without these, and as many ranks as processors.
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


class Commands(unittest.TestCase):
    """One test for each page, added below."""

    maxDiff = None

    def run_commands(self, path):
        environment = {"PATH": f"{BUILD / 'bin'}:{os.environ['PATH']}", "PYTHONPATH": str(BUILD / "python"), **MPI}
        with tempfile.TemporaryDirectory(prefix="podm-docs-") as folder:
            self.assertEqual(run_page(path.read_text(encoding="utf-8"), folder, environment), [])


def _test_of(path):
    return lambda self: self.run_commands(path)


for _path in PAGES:
    _name = str(_path.relative_to(ROOT)).removesuffix(".md").lower().replace("/", "_")
    setattr(Commands, f"test_{_name}", _test_of(_path))


class Links(unittest.TestCase):
    def test_each_leads_to_a_file_and_a_heading(self):
        self.assertEqual(faults_of_links(ROOT, pages_of(ROOT)), [])

    def test_each_page_of_docs_is_in_the_navigation_of_the_site(self):
        navigation = (ROOT / "docs" / "mkdocs.yml").read_text(encoding="utf-8")
        for path in (ROOT / "docs").rglob("*.md"):
            self.assertIn(f" {path.relative_to(ROOT)}\n", navigation)


if __name__ == "__main__":
    unittest.main()
