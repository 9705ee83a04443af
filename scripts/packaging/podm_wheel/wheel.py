"""Puts files into a wheel."""
import os
import shutil
import subprocess
import sys
from pathlib import Path


def metadata(root, folder):
    """Writes what setup.py says about the package into a folder NAME-VERSION.dist-info. Returns this folder."""
    code = ("import sys; from setuptools.build_meta import prepare_metadata_for_build_wheel as prepare; "
            "print(prepare(sys.argv[1]))")
    done = subprocess.run([sys.executable, "-c", code, folder], cwd=root / "mesher/python", check=True,
                          capture_output=True, text=True)
    # setuptools leaves this folder. pip would read it instead of RECORD when it uninstalls.
    for other in folder.glob("*.egg-info"):
        shutil.rmtree(other)
    return folder / done.stdout.split()[-1]


def python_files(source, built, package):
    """Copies the modules and the stubs of the package: those of the source tree and those that the build makes."""
    package.mkdir(parents=True, exist_ok=True)
    for folder in (source, built):
        for path in folder.iterdir():
            if path.suffix in (".py", ".pyi") or path.name == "py.typed":
                shutil.copy(path, package)


def install(build, component, prefix):
    environment = {name: value for name, value in os.environ.items() if name != "DESTDIR"}
    subprocess.run(["cmake", "--install", build, "--component", component, "--prefix", prefix], check=True,
                   stdout=subprocess.DEVNULL, env=environment)


def copy_scripts(program, names, folder):
    folder.mkdir(parents=True)
    for name in names:
        shutil.copy(program, folder / name)
        (folder / name).chmod(0o755)


def pack(tree, info, tag, output):
    """Writes the wheel of the tree. Returns its path."""
    (info / "WHEEL").write_text(f"Wheel-Version: 1.0\nGenerator: podmark\nRoot-Is-Purelib: false\nTag: {tag}\n")
    output.mkdir(parents=True, exist_ok=True)
    done = subprocess.run([sys.executable, "-m", "wheel", "pack", "--dest-dir", output, tree], check=True,
                          capture_output=True, text=True)
    return Path(done.stdout.strip().rpartition("Repacking wheel as ")[2].removesuffix("...OK"))
