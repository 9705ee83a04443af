"""A hidden display. Debian's build of VTK draws only through X."""
import contextlib
import ctypes
import os
import secrets
import signal
import struct
import subprocess
import tempfile
from pathlib import Path

from .mesh import MeshError

SERVER = "/usr/bin/Xvfb"
PR_SET_PDEATHSIG = 1  # from linux/prctl.h
FAMILY_WILD = 0xFFFF  # matches any display


@contextlib.contextmanager
def hidden_display():
    """Starts a display for this process only: it requires a cookie. The display ends with this process, even if the
    process is killed. Raises MeshError if the server is missing."""
    if not os.access(SERVER, os.X_OK):
        raise MeshError(f"view: {SERVER} is not installed; install Debian's xvfb")
    with tempfile.TemporaryDirectory() as folder:
        cookie = Path(folder) / "cookie"
        cookie.write_bytes(_authority(secrets.token_bytes(16)))
        number_reader, number_writer = os.pipe()
        server = subprocess.Popen(
            [SERVER, "-displayfd", str(number_writer), "-screen", "0", "64x64x24", "-nolisten", "tcp", "-auth", cookie],
            pass_fds=[number_writer], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=_end_with_parent)
        os.close(number_writer)
        try:
            with open(number_reader) as pipe:  # the server chooses a free number
                number = pipe.readline().strip()
            if not number:
                raise MeshError(f"view: {SERVER} does not start")
            os.environ.update(DISPLAY=f":{number}", XAUTHORITY=str(cookie))
            yield
        finally:
            server.terminate()
            server.wait()


def _authority(cookie):
    """Returns an entry of an Xauthority file: family, then address, number, name and data, each after its length."""
    fields = (b"", b"", b"MIT-MAGIC-COOKIE-1", cookie)
    return struct.pack(">H", FAMILY_WILD) + b"".join(struct.pack(">H", len(field)) + field for field in fields)


def _end_with_parent():
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
