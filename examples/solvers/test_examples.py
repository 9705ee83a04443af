"""Tests that each example makes a picture from a segmentation, and that its solver reads the mesh that podm
recorded."""

import importlib.util
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).parent


def is_installed(module):
    """True if the module is installed. A folder of that name beside this file looks like a module, but has no
    origin."""
    spec = importlib.util.find_spec(module)
    return spec is not None and spec.origin is not None


class SolverExamples(unittest.TestCase):
    def run_example(self, script, picture, programs=(), modules=()):
        missing = [name for name in programs if shutil.which(name) is None]
        missing += [name for name in modules if not is_installed(name)]
        if missing:
            self.skipTest("needs " + ", ".join(missing) + ": scripts/setup-solvers")
        with tempfile.TemporaryDirectory() as folder:
            process = subprocess.run([sys.executable, HERE / script, folder], capture_output=True, text=True,
                                     timeout=300, check=False)
            self.assertEqual(process.returncode, 0, process.stdout + process.stderr)
            self.assertTrue((pathlib.Path(folder) / picture).read_bytes().startswith(b"\x89PNG"))

    def test_calculix(self):
        self.run_example("calculix/pressed_abdomen.py", "pressed_abdomen.png", ["ccx"])

    def test_dolfinx(self):
        self.run_example("dolfinx/heat_in_liver.py", "heat_in_liver.png", modules=["dolfinx", "h5py"])

    def test_freefem(self):
        self.run_example("freefem/heat_in_liver.py", "heat_in_liver.png", ["FreeFem++"], ["meshio"])

    def test_sfepy(self):
        self.run_example("sfepy/heat_in_liver.py", "heat_in_liver.png", modules=["sfepy", "meshio"])


if __name__ == "__main__":
    unittest.main()
