"""Independent pieces of work side by side: the filter and the algebra leave Python alone while they run."""

import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, TypeVar

from jobs.threads import threads

Found = TypeVar("Found")
# More would wait for one another: between two answers of the filter Python decides what to ask next.
WORKERS = min(2, threads())
_POOL = ThreadPoolExecutor(WORKERS)
_AHEAD = ThreadPoolExecutor(WORKERS)  # pieces that will be asked for, which must not stand in the way of those that are
_HERE = threading.local()


def thread_map(function: Callable[..., Found], *items: Iterable[Any]) -> list[Found]:
    """As list(map(function, *items)), on several cores; raises what the first failing piece raised, ValueError for items of unlike lengths.

    Pieces may call this again: they then do themselves what no other worker has begun, so none ever waits for one that waits for it.
    """
    pieces = list(zip(*items, strict=True))
    asked = [_POOL.submit(_piece, function, piece) for piece in pieces]
    if not getattr(_HERE, "works", False):
        return [one.result() for one in asked]
    own = {place: function(*pieces[place]) for place, one in enumerate(asked) if one.cancel()}
    return [own[place] if place in own else one.result() for place, one in enumerate(asked)]


def at_once(*pieces: Callable[[], Any]) -> list[Any]:
    """What the pieces return, in their order."""
    return thread_map(lambda piece: piece(), pieces)


def begin(function: Callable[..., object], *items: object) -> None:
    """Begin what somebody will ask for; the process does not end before it is done."""
    _AHEAD.submit(function, *items)


@contextmanager
def through_when_interrupted() -> Iterator[None]:
    """Interrupted, the body leaves no piece to be begun, and those at work end at their next question: for a process that ends then."""
    try:
        yield
    except KeyboardInterrupt:
        for pool in (_POOL, _AHEAD):
            pool.shutdown(wait=False, cancel_futures=True)
        raise


def _piece(function: Callable[..., Found], piece: tuple[Any, ...]) -> Found:
    _HERE.works = True
    return function(*piece)
