"""The prediction beside what is watched, made ready before anything can be armed."""

from collections.abc import Sequence

from diagnosis.validate.ahead import AHEAD_MEMORY_S, EVERY_S, Lookahead
from records.logs.live import LiveRow
from sim.bind import BoundPlant


def ready_lookahead(bound: BoundPlant, locked: Sequence[str]) -> Lookahead:
    """A lookahead that has predicted once, and forgotten it.

    Its first prediction compiles for seconds. In a flight that would be a host which is silent for longer than the board waits.
    """
    lookahead = Lookahead(bound, locked)
    u, y = (tuple(0.0 for _ in names) for names in (bound.model.inputs, bound.model.outputs))
    lookahead.take([LiveRow(k * EVERY_S, u, y, ()) for k in range(round(AHEAD_MEMORY_S / EVERY_S))])
    lookahead.forget()
    return lookahead
