"""Ends podm by signals, and returns how it ended."""

import collections
import re
import time

from podm_process import start_podm

LONGEST_S = 1
ENDLESS = ["mesh", "phantom:abdomen@48", "--radius", 1, "--max-memory-gib", 1000, "--oversubscribe"]

End = collections.namedtuple("End", "code stderr seconds")


def end_of(process, first, *others, pause_s=0):
    """Returns how the process ends after these signals, and the time since the last."""
    sent = time.monotonic()
    process.send_signal(first)
    for number in others:
        time.sleep(pause_s)
        sent = time.monotonic()
        process.send_signal(number)
    try:
        _, stderr = process.communicate(timeout=60)
    finally:
        process.kill()  # no effect if it has ended
    return End(process.returncode, stderr, time.monotonic() - sent)


def start_refining(*arguments, **popen_options):
    process = start_podm(*arguments, **popen_options)
    for line in process.stderr:
        if re.match("refine", line):
            return process
    raise AssertionError(f"no refinement: exit {process.wait()}")
