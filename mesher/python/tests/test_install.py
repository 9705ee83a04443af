"""pip installs the package from the source tree without a network, and leaves the tree as it is."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

from podm.processor import check_processor

SOURCE = pathlib.Path(__file__).resolve().parents[1]
CODE = """
import pathlib, numpy as np, podm
image = np.zeros((12, 12, 12), np.uint8)
image[3:9, 3:9, 3:9] = 1
mesh = podm.mesh(image)
assert mesh.verify(), mesh.verify().text
folder = pathlib.Path(podm.__file__).parent
assert (folder / "py.typed").exists() and (folder / "meshing.pyi").exists()
print(podm.__file__)
"""


def files_of_source():
    return {path for path in SOURCE.rglob("*") if "__pycache__" not in path.parts}


class InstallTest(unittest.TestCase):
    def test_a_processor_without_the_instructions_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "cpuinfo")
            for flags, is_refused in (("fpu sse4_2 avx", True), ("fpu avx avx2 bmi1 bmi2 fma", False), ("", False)):
                path.write_text(f"processor: 0\nmodel name: x\n{flags and 'flags: ' + flags}\n")
                if is_refused:
                    self.assertRaisesRegex(ImportError, "no avx2, bmi1, bmi2, fma;", check_processor, path)
                else:
                    check_processor(path)
            check_processor(path.with_name("none"))

    def test_pip_installs_what_meshes_and_verifies(self):
        before = files_of_source()
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", folder], check=True)
            python = pathlib.Path(folder, "bin", "python3")
            install = [python, "-m", "pip", "install", "--no-index", "--no-build-isolation", SOURCE]
            pip = subprocess.run(install, env=environment, capture_output=True, text=True, check=False)
            self.assertEqual(pip.returncode, 0, pip.stdout + pip.stderr)
            process = subprocess.run([python, "-c", CODE], env=environment, cwd=folder, capture_output=True, text=True,
                                     check=False)
            self.assertEqual(process.returncode, 0, process.stderr)
            self.assertTrue(process.stdout.startswith(os.path.realpath(folder)), process.stdout)
            for program in ("podm", "podm-verify", "podm-bench"):
                said = subprocess.run([pathlib.Path(folder, "bin", program), "--version"], env=environment, check=True,
                                      capture_output=True, text=True).stdout
                self.assertTrue(said.startswith(f"{program} "), said)
        self.assertEqual(files_of_source(), before)


if __name__ == "__main__":
    unittest.main()
