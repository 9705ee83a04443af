"""Lets pip install the package: `pip install --no-build-isolation ./mesher/python`, without a network.

CMake builds the extension module and podm-verify, as `make python` does and in the same folder, build/. The variable
PODM_BUILD names another folder.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("PODM_BUILD", ROOT / "build")).absolute()
SCRATCH = BUILD / "python-setup"  # keeps the source tree clean


class BuildByCMake(build_ext):
    def build_extension(self, ext):
        python = os.path.realpath(sys.executable)
        subprocess.run(["cmake", "-S", ROOT, "-B", BUILD, "-G", "Ninja", f"-DPODM_PYTHON={python}", "-DPODM_UNITE=ON"],
                       check=True)
        subprocess.run(["cmake", "--build", BUILD, "--target", "podm_python_package"], check=True)
        package = pathlib.Path(self.get_ext_fullpath(ext.name)).parent
        package.mkdir(parents=True, exist_ok=True)
        for built in [*BUILD.glob("python/podm/_podm*.so"), BUILD / "python/podm/podm-verify"]:
            shutil.copy2(built, package)


def version():
    return re.search(r"project\(podm VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]


SCRATCH.mkdir(parents=True, exist_ok=True)
setup(
    name="podm",
    version=version(),
    description="Tetrahedral meshes with guarantees from segmented 3-D images",
    license="BSD-3-Clause",
    python_requires=">=3.11",
    install_requires=["numpy"],
    packages=["podm"],
    package_data={"podm": ["py.typed", "*.pyi"]},
    ext_modules=[Extension("podm._podm", sources=[])],
    cmdclass={"build_ext": BuildByCMake},
    options={"build": {"build_base": str(SCRATCH)}, "egg_info": {"egg_base": str(SCRATCH)}},
    zip_safe=False,
)
