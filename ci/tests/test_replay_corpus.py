"""The replay of a corpus fails if the target fails on one of its inputs, and then names this input."""
import os
import pathlib
import subprocess
import tempfile
import unittest


class ReplayCorpus(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def replay(self, **inputs):
        for name, text in inputs.items():
            (self.folder / name).write_text(text)
        return subprocess.run([os.environ["PODM_REPLAY"], self.folder], capture_output=True, text=True)

    def test_passes_if_no_input_fails(self):
        done = self.replay(empty="", some="text")
        self.assertEqual((done.returncode, done.stdout), (0, f"2 inputs of {self.folder}\n"), done.stderr)

    def test_fails_and_names_the_input(self):
        for text in ("abort", "throw", "overflow"):
            with self.subTest(text):
                done = self.replay(a="first", b=text, c="last")
                self.assertLess(done.returncode, 0)  # ended by a signal
                self.assertIn(f"failed on input {self.folder}/b\n", done.stderr)
                self.assertEqual(done.stdout, "")

    def test_refuses_a_folder_without_inputs(self):
        done = self.replay()
        self.assertEqual((done.returncode, done.stderr), (2, f"{self.folder}: no file\n"))

    def test_refuses_a_folder_that_does_not_exist(self):
        self.folder /= "missing"
        done = self.replay()
        self.assertEqual(done.returncode, 2)
        self.assertIn(str(self.folder), done.stderr)


if __name__ == "__main__":
    unittest.main()
