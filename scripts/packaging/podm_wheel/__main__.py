"""The command line of scripts/packaging/make_wheel."""
import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from . import binary, wheel
from .build_tree import BuildTree
from .linker import Linker

ROOT = Path(__file__).resolve().parents[3]
PROGRAMS = ("podm", "podm-verify", "podm-bench")
MOST_BYTES = 25e6
ASK_PYTHON = """
import json, sys, sysconfig
print(json.dumps({"tag": f"cp{sys.version_info[0]}{sys.version_info[1]}", "headers": sysconfig.get_path("include"),
                  "suffix": sysconfig.get_config_var("EXT_SUFFIX")}))
"""


def arguments_of(words):
    parser = argparse.ArgumentParser(
        prog="make_wheel", description="Links the programs and the extension module of a build again, for all systems "
        "with glibc and a processor of the level that they are compiled for, and writes a wheel of them.")
    parser.add_argument("--build", type=Path, default=ROOT / "build-profiled", metavar="FOLDER",
                        help="the finished build, by `make profiled` [default: build-profiled]")
    parser.add_argument("--libraries", type=Path, default=ROOT / "build-wheel", metavar="FOLDER",
                        help="what scripts/packaging/libraries has made [default: build-wheel]")
    parser.add_argument("--python", default="/usr/bin/python3", metavar="FILE",
                        help="the CPython whose version the wheel is for [default: /usr/bin/python3]")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "dist", metavar="FOLDER",
                        help="where the wheel is written [default: dist]")
    return parser.parse_args(words)


def compile_module(tree, libraries, python, scratch):
    """Compiles the extension module for this Python, with a pybind11 that knows all versions of numpy. Returns the
    object files."""
    objects = []
    for command in tree.compile_commands("podm_python.dir"):
        of_debians_python = next(at for at, word in enumerate(command) if word.startswith("/usr/include/python3"))
        command[of_debians_python] = python["headers"]
        objects.append(scratch / f"{len(objects)}.o")
        subprocess.run([*command, "-isystem", libraries / "pybind11", "-o", objects[-1]], check=True, cwd=tree.folder)
    return objects


def make(options, scratch):
    """Returns the path of the wheel."""
    tree = BuildTree(options.build.resolve())
    libraries = options.libraries.resolve()
    python = json.loads(subprocess.run([options.python, "-c", ASK_PYTHON], check=True, capture_output=True,
                                       text=True).stdout)
    staged = scratch / "wheel"
    package = staged / "podm"
    data = staged / f"podmark-{tree.version()}.data"
    wheel.python_files(ROOT / "mesher/python/podm", tree.folder / "python/podm", package)
    wheel.install(tree.folder, "programs", package)
    wheel.install(tree.folder, "pages", data / "data")
    wheel.copy_scripts(ROOT / "mesher/python/program", PROGRAMS, data / "scripts")
    info = wheel.metadata(ROOT, staged)
    shutil.copytree(libraries / "copyright", info / "licenses")

    linker = Linker(libraries, package / "libs")
    binaries = [package / "bin" / name for name in PROGRAMS]
    for path in binaries:
        linker.program(tree.parts_of(f"bin/{path.name}"), path, "../libs")
    module = package / ("_podm" + python["suffix"])
    archives = [part for part in tree.parts_of("bin/podm") if part.suffix == ".a"]
    linker.module([*compile_module(tree, libraries, python, scratch), *archives], module, "libs")
    binaries += [module, *linker.bundled]
    for path in binaries:
        binary.check(path)
    major, minor = max(map(binary.glibc_version, binaries))
    return wheel.pack(staged, info, f"{python['tag']}-{python['tag']}-manylinux_{major}_{minor}_x86_64", options.output)


def main(words=None):
    options = arguments_of(words)
    with tempfile.TemporaryDirectory(prefix="podm-wheel-") as scratch:
        try:
            path = make(options, Path(scratch))
        except binary.Unportable as error:
            print(f"make_wheel: {error}", file=sys.stderr)
            return 1
    print(f"{path}: {path.stat().st_size / 1e6:.1f} MB")
    if path.stat().st_size > MOST_BYTES:
        print(f"make_wheel: {path} is larger than {MOST_BYTES / 1e6:.0f} MB", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
