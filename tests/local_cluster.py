"""A Dask cluster of separate processes on this machine's loopback."""

import os
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def local_cluster(workers=2):
    """Start a cluster and yield its scheduler's address."""
    import dask
    from distributed import LocalCluster

    # A worker imports the tests' helpers by name, as a process of a pool does.
    folder = str(Path(__file__).parent)
    path = os.pathsep.join([folder, str(Path(folder).parent), os.environ.get("PYTHONPATH", "")])
    settings = {"distributed.worker.profile.enabled": False}
    with (
        dask.config.set(settings),
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address=None,
            silence_logs=50,
            env={"PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1"},
        ) as started,
    ):
        yield started.scheduler_address
