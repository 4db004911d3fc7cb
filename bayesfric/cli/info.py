"""``bayesfric info``: versions, linear algebra and threads."""

from pathlib import Path

from bayesfric.cli.exits import exit_status
from bayesfric.cli.printing import say


@exit_status
def info() -> None:
    """Print the versions, BLAS and threads that a result depends on.

    Example: bayesfric info
    """
    import numpy  # noqa: F401  (loads the BLAS that is told about)
    from threadpoolctl import threadpool_info

    from bayesfric.results import package_versions
    from bayesfric.rigs import all_rigs

    say(f"{'rigs':<14} {', '.join(all_rigs())}")
    for name, version in package_versions().items():
        say(f"{name:<14} {version}")
    for pool in threadpool_info():
        version = pool.get("version") or "unknown version"
        say(
            f"{pool['user_api']:<14} {pool['internal_api']} {version} "
            f"in {Path(pool['filepath']).parent.name}, "
            f"{pool['num_threads']} threads (one while fitting)"
        )
