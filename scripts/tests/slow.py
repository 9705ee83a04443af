"""Marks of tests and cases that take too long for every commit. `make test SLOW=1` and ci/nightly run them, too."""
import os
import unittest

_RUNS_ALL = bool(os.environ.get("PODM_SLOW_TESTS"))

slow = unittest.skipUnless(_RUNS_ALL, "slow; PODM_SLOW_TESTS=1 runs it")


def few(cases, number):
    """Returns the first `number` cases, or all of them where slow tests run."""
    cases = list(cases)
    return cases if _RUNS_ALL else cases[:number]
