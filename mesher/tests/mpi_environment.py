"""The environment in which tests start MPI programs. Other implementations ignore the variables of Open MPI."""

import contextlib
import os
import tempfile


@contextlib.contextmanager
def mpi_environment():
    """Provides an environment with a folder of its own for the sessions of Open MPI. A program may fail to start while
    another one removes the folder that both would use."""
    # The path is short, because sockets have their names in it.
    with tempfile.TemporaryDirectory(prefix="ompi", dir="/tmp", ignore_cleanup_errors=True) as sessions:
        yield {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1",
               "OMPI_MCA_orte_tmpdir_base": sessions}
