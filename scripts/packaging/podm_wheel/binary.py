"""The needs of an ELF file: libraries and symbol versions of the system on which it runs."""
import re
import subprocess

# The C library. Everything else comes with the wheel.
OF_THE_SYSTEM = {"libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2", "librt.so.1", "ld-linux-x86-64.so.2"}


class Unportable(Exception):
    """A file of the wheel needs something that a system may lack."""


def _readelf(option, path):
    return subprocess.run(["readelf", "--wide", option, path], check=True, capture_output=True, text=True).stdout


def needed(path):
    """Returns the names of the shared libraries that the file needs."""
    return set(re.findall(r"\(NEEDED\).*\[(.+)\]", _readelf("--dynamic", path)))


def search_path(path):
    """Returns the folders in which the file looks for libraries first."""
    found = re.search(r"\((?:RUNPATH|RPATH)\).*\[(.*)\]", _readelf("--dynamic", path))
    return found[1].split(":") if found else []


def glibc_version(path):
    """Returns the newest version of a symbol that the file takes from the C library, such as (2, 31)."""
    versions = re.findall(r"Name: GLIBC_(\d+)\.(\d+)", _readelf("--version-info", path))
    return max(((int(major), int(minor)) for major, minor in versions), default=(2, 2))


def check(path):
    """Raises Unportable if the file needs a library that is neither of the C library nor beside it in the wheel, or if
    it looks for libraries outside the wheel."""
    inside = [folder for folder in search_path(path) if folder.partition("/")[0] == "$ORIGIN"]
    beside = {file.name for folder in inside
              for file in (path.parent / folder.removeprefix("$ORIGIN").lstrip("/")).glob("*")}
    missing = needed(path) - OF_THE_SYSTEM - beside
    if missing:
        raise Unportable(f"{path}: it needs {', '.join(sorted(missing))}")
    outside = [folder for folder in search_path(path) if folder not in inside]
    if outside:
        raise Unportable(f"{path}: it looks for libraries in {', '.join(outside)}")
