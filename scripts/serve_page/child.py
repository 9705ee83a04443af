"""Runs one program within limits of memory and time."""
import signal
import subprocess
import threading
import time
from dataclasses import dataclass
from pathlib import Path

PERIOD_S = 0.1  # between two looks at the memory
KEPT_BYTES = 1 << 16  # of standard error, the last
KIB = 1024


@dataclass(frozen=True)
class Limits:
    """Limits of each program."""

    memory_bytes: int
    seconds: float


@dataclass(frozen=True)
class Ended:
    """`broken`: the limit that ended the program, as a sentence; or empty."""

    exit_code: int
    output: str
    errors: str
    broken: str


class Child:
    """A program that runs in `folder`. It has its own session, so that Ctrl-C reaches the server alone."""

    def __init__(self, command, folder, limits, on_line=None):
        self._limits, self._on_line = limits, on_line
        self._broken = ""
        self._process = subprocess.Popen(list(map(str, command)), cwd=folder, stdin=subprocess.DEVNULL,
                                         stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)

    def wait(self):
        """Returns the ended program. Calls `on_line` for each line of its output."""
        errors = []
        reader = threading.Thread(target=lambda: errors.append(_last_bytes(self._process.stderr)), daemon=True)
        watch = threading.Thread(target=self._watch, daemon=True)
        reader.start()
        watch.start()
        lines = []
        for line in self._process.stdout:
            text = line.decode(errors="replace")
            if self._on_line:
                self._on_line(text)
            else:
                lines.append(text)
        exit_code = self._process.wait()
        reader.join()
        watch.join()
        for stream in (self._process.stdout, self._process.stderr):
            stream.close()
        return Ended(exit_code, "".join(lines), errors[0].decode(errors="replace"), self._broken)

    def stop(self):
        """Asks the program to end with what it has."""
        self._send(signal.SIGINT)

    def kill(self):
        self._send(signal.SIGKILL)

    def _send(self, number):
        if self._process.poll() is None:
            self._process.send_signal(number)

    def _watch(self):
        start_s = time.monotonic()
        while self._process.poll() is None and not self._broken:
            if _resident_bytes(self._process.pid) > self._limits.memory_bytes:
                gib = self._limits.memory_bytes / 2**30
                self._broken = f"it needs more than the {gib:.3g} GiB that a program may take"
            elif time.monotonic() - start_s > self._limits.seconds:
                self._broken = f"it takes more than the {self._limits.seconds:g} s that a program may take"
            if self._broken:
                self.kill()
            time.sleep(PERIOD_S)


def _last_bytes(stream):
    kept = b""
    while part := stream.read1(KEPT_BYTES):
        kept = (kept + part)[-KEPT_BYTES:]
    return kept


def _resident_bytes(process):
    try:
        for line in Path(f"/proc/{process}/status").read_text().splitlines():
            if line.startswith("VmRSS:"):
                return int(line.split()[1]) * KIB
    except (OSError, ValueError):
        pass
    return 0


def available_bytes():
    """Returns 80 % of the memory that the system has available, as podm does by itself."""
    for line in Path("/proc/meminfo").read_text().splitlines():
        if line.startswith("MemAvailable:"):
            return int(0.8 * int(line.split()[1]) * KIB)
    raise RuntimeError("/proc/meminfo has no line MemAvailable")
