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


def soname(path):
    """Returns the name by which other files need this library."""
    return re.search(r"\(SONAME\).*\[(.+)\]", _readelf("--dynamic", path))[1]


def search_path(path):
    """Returns the folders in which the file looks for libraries first."""
    found = re.search(r"\((?:RUNPATH|RPATH)\).*\[(.*)\]", _readelf("--dynamic", path))
    return found[1].split(":") if found else []


def glibc_version(path):
    """Returns the newest version of a symbol that the file takes from the C library, such as (2, 31)."""
    versions = re.findall(r"Name: GLIBC_(\d+)\.(\d+)", _readelf("--version-info", path))
    return max(((int(major), int(minor)) for major, minor in versions), default=(2, 2))


def _symbols(path, which):
    """Returns the dynamic symbols of the file that nm lists with the option `which`, with their versions."""
    listed = subprocess.run(["nm", "--dynamic", which, path], check=True, capture_output=True, text=True).stdout
    return {name for kind, name in re.findall(r"^[0-9a-f ]*([A-Za-z]) (\S+)$", listed, re.MULTILINE)
            if kind not in "vw"}  # a weak one may be missing


def undefined(path, libraries):
    """Returns the symbols without a version that none of the libraries defines. Symbols of the C library have versions;
    names of Python's begin with Py or _Py."""
    without_version = {name for name in _symbols(path, "--undefined-only") if "@" not in name}
    defined = {name.partition("@")[0] for library in libraries for name in _symbols(library, "--defined-only")}
    return {name for name in without_version - defined if not name.startswith(("Py", "_Py"))}


def check(path):
    """Raises Unportable if the file needs a library that is neither of the C library nor beside it in the wheel, if it
    looks for libraries outside the wheel, or if no library defines one of its symbols."""
    inside = [folder for folder in search_path(path) if folder.partition("/")[0] == "$ORIGIN"]
    beside = {file.name: file for folder in inside
              for file in (path.parent / folder.removeprefix("$ORIGIN").lstrip("/")).glob("*")}
    missing = needed(path) - OF_THE_SYSTEM - beside.keys()
    if missing:
        raise Unportable(f"{path}: it needs {', '.join(sorted(missing))}")
    outside = [folder for folder in search_path(path) if folder not in inside]
    if outside:
        raise Unportable(f"{path}: it looks for libraries in {', '.join(outside)}")
    lacking = undefined(path, [beside[name] for name in needed(path) & beside.keys()])
    if lacking:
        raise Unportable(f"{path}: no library defines {', '.join(sorted(lacking))}")
