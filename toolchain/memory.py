"""Memory that is freed and soon wanted again."""

import ctypes

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3  # mallopt(3), where there is glibc
LARGEST_KEPT = 1 << 30  # bytes


def keep_freed_memory() -> None:
    """Have the C library keep what is freed: arrays of tens of megabytes come and go in a search, and pages touched anew cost a tenth of
    its time. Without effect where the C library has no mallopt.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_TRIM_THRESHOLD, LARGEST_KEPT)
        mallopt(M_MMAP_THRESHOLD, LARGEST_KEPT)
