"""The mark of tests that take too long for every commit. `make test SLOW=1` and ci/nightly run them, too."""
import os
import unittest

slow = unittest.skipUnless(os.environ.get("PODM_SLOW_TESTS"), "slow; PODM_SLOW_TESTS=1 runs it")
