"""Lets pip install the package: `pip install --no-build-isolation ./mesher/python`, without a network.

CMake builds the extension module and the programs, as `make build python` does and in the same folder, build/. The
variable PODM_BUILD names another folder. In a source distribution this file is at the top of the tree.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = pathlib.Path(__file__).resolve().parent
ROOT = next(folder for folder in (HERE, *HERE.parents) if (folder / "CITATION.cff").exists())
SOURCE = ROOT / "mesher" / "python"
BUILD = pathlib.Path(os.environ.get("PODM_BUILD", ROOT / "build")).absolute()
SCRATCH = BUILD / "python-setup"  # keeps the source tree clean
PROGRAMS = ("podm", "podm-verify", "podm-bench")


class BuildByCMake(build_ext):
    def build_extension(self, ext):
        python = os.path.realpath(sys.executable)
        subprocess.run(["cmake", "-S", ROOT, "-B", BUILD, "-G", "Ninja", f"-DPODM_PYTHON={python}", "-DPODM_UNITE=ON"],
                       check=True)
        subprocess.run(["cmake", "--build", BUILD, "--target", "podm_python_package", *PROGRAMS], check=True)
        package = pathlib.Path(self.get_ext_fullpath(ext.name)).parent
        for built in BUILD.glob("python/podm/*"):
            if built.suffix in (".so", ".pyi") or built.name == "built_for.py":
                package.mkdir(parents=True, exist_ok=True)
                shutil.copy2(built, package)
        # The package is also the folder into which the programs are installed.
        subprocess.run(["cmake", "--install", BUILD, "--component", "programs", "--prefix", package, "--strip"],
                       check=True)


def version():
    return re.search(r"project\(podm VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]


def scripts():
    """Returns one copy of `program` for each program, as a path relative to this folder."""
    folder = SCRATCH / "scripts"
    folder.mkdir(parents=True, exist_ok=True)
    return [os.path.relpath(shutil.copy(SOURCE / "program", folder / name), HERE) for name in PROGRAMS]


SCRATCH.mkdir(parents=True, exist_ok=True)
os.chdir(HERE)
setup(
    name="podmark",
    version=version(),
    description="Tetrahedral meshes with guarantees from segmented 3-D images",
    long_description=(ROOT / "README.md").read_text(encoding="utf-8"),
    long_description_content_type="text/markdown",
    license="BSD-3-Clause",
    license_files=[os.path.relpath(ROOT / "LICENSE", HERE)],
    classifiers=["Intended Audience :: Science/Research", "License :: OSI Approved :: BSD License",
                 "Operating System :: POSIX :: Linux", "Programming Language :: C++",
                 "Programming Language :: Python :: 3", "Topic :: Scientific/Engineering"],
    python_requires=">=3.11",
    install_requires=["numpy"],
    packages=["podm"],
    package_dir={"": os.path.relpath(SOURCE, HERE)},
    package_data={"podm": ["py.typed", "*.pyi"]},
    scripts=scripts(),
    ext_modules=[Extension("podm._podm", sources=[])],
    cmdclass={"build_ext": BuildByCMake},
    options={"build": {"build_base": str(SCRATCH)}, "egg_info": {"egg_base": str(SCRATCH)}},
    zip_safe=False,
)
