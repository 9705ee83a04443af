"""ci/nightly runs every check, also after one that fails, and fails if one did."""
import pathlib
import shutil
import subprocess
import tempfile
import unittest

CI = pathlib.Path(__file__).parents[1]


class Nightly(unittest.TestCase):
    """In a repository of its own that holds only the scripts under test."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        (self.folder / "ci").mkdir()
        for name in ("nightly", "steps.sh"):
            shutil.copy(CI / name, self.folder / "ci")
        for command in (["init", "-q"], ["add", "."], ["commit", "-q", "-m", "Scripts"]):
            subprocess.run(["git", "-c", "user.name=test", "-c", "user.email=test@localhost", *command],
                           cwd=self.folder, check=True)

    def nightly(self, *checks):
        return subprocess.run([self.folder / "ci/nightly", *checks], capture_output=True, text=True)

    def test_passes_if_all_checks_pass(self):
        done = self.nightly("true", "echo from the check")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("\nfrom the check\n", done.stdout)
        self.assertTrue(done.stdout.endswith("\n0 of 2 checks failed\n"))

    def test_runs_the_checks_after_a_failure_and_fails(self):
        done = self.nightly("exit 3", "echo from the last check")
        self.assertEqual(done.returncode, 1)
        self.assertIn("== exit 3: failed with exit code 3, ", done.stdout)
        self.assertIn("\nfrom the last check\n", done.stdout)
        self.assertRegex(done.stdout, r"\nFAILED +\d+ s  exit 3\npassed +\d+ s  echo from the last check\n"
                                      r"1 of 2 checks failed\n$")

    def test_a_check_that_changes_the_working_tree_fails(self):
        done = self.nightly("touch left_behind")
        self.assertEqual(done.returncode, 1)
        self.assertIn("left changes in the working tree", done.stdout)


if __name__ == "__main__":
    unittest.main()
