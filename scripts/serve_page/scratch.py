"""The server's own folder, which holds all files that it reads and writes."""
import fcntl
import os
import shutil
import tempfile
from pathlib import Path

PREFIX = "podm-serve-"
LOCK = "lock"


class Scratch:
    """A folder that only this user may enter. It is gone after close(). A server that was killed leaves its folder
    behind; the next server finds by the lock that it is unused, and removes it."""

    def __init__(self):
        _remove_unused(Path(tempfile.gettempdir()))
        while not self._has_locked_a_new_folder():
            pass

    def _has_locked_a_new_folder(self):
        """Returns false if another server that starts has removed the folder before it was locked."""
        self.path = Path(tempfile.mkdtemp(prefix=PREFIX))
        try:
            self._lock = open(self.path / LOCK, "w")
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (FileNotFoundError, BlockingIOError):
            return False
        return (self.path / LOCK).exists()

    def new_folder(self):
        return Path(tempfile.mkdtemp(dir=self.path))

    def close(self):
        shutil.rmtree(self.path, ignore_errors=True)
        self._lock.close()


def _remove_unused(folder):
    for path in folder.glob(f"{PREFIX}*"):
        try:
            if path.is_symlink() or path.stat().st_uid != os.getuid():
                continue
            with open(path / LOCK) as lock:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(path, ignore_errors=True)
        except OSError:  # in use, or not of a server
            continue
