"""The example runs from an image to a picture."""

import pathlib
import subprocess
import sys
import unittest

from balls import TestCase

EXAMPLE = pathlib.Path(__file__).resolve().parents[3] / "examples" / "python" / "image_to_picture.py"


class ExampleTest(TestCase):
    def test_the_script_draws_a_mesh(self):
        process = subprocess.run([sys.executable, EXAMPLE], cwd=self.folder, capture_output=True, text=True,
                                 check=False)
        self.assertEqual(process.returncode, 0, process.stdout + process.stderr)
        import matplotlib.image
        for name in ("quality.png", "mesh.png"):
            pixels = matplotlib.image.imread(self.folder / name)[..., :3]
            self.assertGreater(min(pixels.shape[:2]), 300)
            self.assertGreater(len(set(map(tuple, pixels.reshape(-1, 3)[::97]))), 20, f"{name} shows something")
        self.assertTrue((self.folder / "mesh.vtu").exists())


if __name__ == "__main__":
    unittest.main()
