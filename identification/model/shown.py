"""Which parameters can show in logs at all: those that act on a reading by another way than through an axis that was never read."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np
import sympy

from records.log import RunLog
from sim.model import Model


def unread(model: Model, logs: Mapping[str, RunLog]) -> tuple[str, ...]:
    """The outputs of which no log has a single reading."""
    read = [np.any(np.isfinite(log.y), axis=0) for log in logs.values()]
    return tuple(output for output, known in zip(model.outputs, np.any(read, axis=0), strict=True) if not known)


def hidden(model: Model, names: Sequence[str], outputs: Collection[str]) -> tuple[str, ...]:
    """Those of the coefficients `names` that show in the unread `outputs` alone.

    How an axis moved that nobody read is guessed, window by window: what came through it would be read off a guess.
    """
    every, left = _reaching(model, ()), _reaching(model, outputs)
    return tuple(name for name in names if name in every - left)


def _reaching(model: Model, unread_outputs: Collection[str]) -> set[str]:
    """All symbols that act on the other outputs, followed back through the rates; axes of the unread ones let nothing pass."""
    rates = dict(zip(model.states, model.state_rates(), strict=True))
    closed = {model.outputs[output] for output in unread_outputs}
    closed |= {axis.velocity for axis in model.axes if axis.position in closed}
    found: set[sympy.Basic] = set()
    todo = [sympy.sympify(output) for name, output in model.outputs.items() if name not in unread_outputs]
    while todo:
        new = todo.pop().free_symbols - found - closed
        found |= new
        todo += [sympy.sympify(rates[symbol]) for symbol in new if symbol in rates]
    return {str(symbol) for symbol in found}
