"""Independent pieces of work side by side: the filter and the algebra leave Python alone while they run."""

import threading
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

from jobs.threads import threads

Found = TypeVar("Found")
# More would wait for one another: between two answers of the filter Python decides what to ask next.
WORKERS = min(2, threads())
_POOL = ThreadPoolExecutor(WORKERS)
_HERE = threading.local()


def each(function: Callable[..., Found], *items: Iterable[Any]) -> list[Found]:
    """As list(map(function, *items)), on several cores; raises what the first failing piece raised, ValueError for items of unlike lengths.

    Pieces may call this again: they then do themselves what no other worker has begun, so none ever waits for one that waits for it.
    """
    pieces = list(zip(*items, strict=True))
    asked = [_POOL.submit(_piece, function, piece) for piece in pieces]
    if not getattr(_HERE, "works", False):
        return [one.result() for one in asked]
    own = {place: function(*pieces[place]) for place, one in enumerate(asked) if one.cancel()}
    return [own[place] if place in own else one.result() for place, one in enumerate(asked)]


def _piece(function: Callable[..., Found], piece: tuple[Any, ...]) -> Found:
    _HERE.works = True
    return function(*piece)
