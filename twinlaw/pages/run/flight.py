"""What a flight of the chain leaves for its page."""

from collections.abc import Mapping
from dataclasses import dataclass

from records.log import RunLog
from sim.tracking import Tracking


@dataclass(frozen=True)
class ChainFlight:
    """A flight's log, how well it followed its references, the counters of the board's line (none without a board), and the `cause` why it
    is not green, "" where it is or nobody asked."""

    log: RunLog
    tracking: tuple[Tracking, ...]
    counters: Mapping[str, int]
    cause: str = ""
