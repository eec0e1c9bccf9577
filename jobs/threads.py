"""How many threads one computation may use for itself: the numeric libraries' own variables, heeded by our threads too."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

COUNTS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def cores() -> int:
    """Processors that this process may run on."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def threads() -> int:
    """Threads for one computation: OMP_NUM_THREADS where it is set, else one a processor."""
    wanted = os.environ.get(COUNTS[0], "").split(",")[0]
    return max(1, int(wanted)) if wanted.isdigit() else cores()


@contextmanager
def told_late() -> Iterator[None]:
    """The body's linear algebra heeds OPENBLAS_NUM_THREADS also where NumPy was loaded before it was set, as in a notebook.

    With a thread for each processor small matrices take some 30 times longer: the threads wait for one another.
    """
    wanted = os.environ.get("OPENBLAS_NUM_THREADS", "")
    if "numpy" not in sys.modules or not wanted.isdigit():
        yield
        return
    from threadpoolctl import threadpool_limits  # commands of a shell have no need of it

    with threadpool_limits(int(wanted), user_api="blas"):
        yield


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Processes that are started in the body compute in one thread each, since there are as many of them as processors."""
    before = {name: os.environ.get(name) for name in COUNTS}
    os.environ.update(dict.fromkeys(COUNTS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
