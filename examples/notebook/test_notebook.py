"""Jupyter runs the notebook from an image to pictures; its committed file has no outputs."""

import base64
import io
import pathlib
import subprocess
import sys
import tempfile
import unittest

import nbformat

NOTEBOOK = pathlib.Path(__file__).resolve().parent / "image_to_picture.ipynb"
# A process of its own: Jupyter's client gives warnings that concern its developers.
EXECUTE = """
import sys, nbclient, nbformat
notebook = nbformat.read(sys.argv[1], as_version=4)
nbclient.NotebookClient(notebook, resources={"metadata": {"path": sys.argv[2]}}).execute()
nbformat.write(notebook, sys.argv[2] + "/executed.ipynb")
"""


class Notebook(unittest.TestCase):
    def test_the_committed_file_is_valid_and_has_no_outputs(self):
        notebook = nbformat.read(NOTEBOOK, as_version=4)
        nbformat.validate(notebook)
        for cell in notebook.cells:
            self.assertFalse(cell.get("outputs"))
            self.assertIsNone(cell.get("execution_count"))

    def test_it_shows_and_saves_pictures_of_a_proved_mesh(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            process = subprocess.run([sys.executable, "-B", "-c", EXECUTE, NOTEBOOK, folder], capture_output=True,
                                     text=True, check=False)
            self.assertEqual(process.returncode, 0, process.stdout + process.stderr)
            self.assertTrue((folder / "mesh.vtu").exists())
            for name in ("quality.png", "mesh.png"):
                self.assert_shows_something((folder / name).read_bytes())
            cells = {cell.id: cell for cell in nbformat.read(folder / "executed.ipynb", as_version=4).cells}
        self.assertIn("guarantees all met", cells["mesh"].outputs[0].text)
        self.assertIn("pass", cells["verify"].outputs[0].text)
        for cell in ("quality", "cut"):
            shown = [output.data for output in cells[cell].outputs if output.output_type == "display_data"]
            self.assert_shows_something(base64.b64decode(shown[0]["image/png"]))

    def assert_shows_something(self, png):
        import matplotlib.image
        pixels = matplotlib.image.imread(io.BytesIO(png))[..., :3]
        self.assertGreater(min(pixels.shape[:2]), 300)
        self.assertGreater(len(set(map(tuple, pixels.reshape(-1, 3)[::97]))), 20)


if __name__ == "__main__":
    unittest.main()
