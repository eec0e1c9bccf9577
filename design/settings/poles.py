"""Poles in rad/s of the continuous plane: of an axis, of its roll-off."""

from typing import Any

from records.errors import BadInput
from records.table import ORDERS
from records.text import checks


def read_poles(entries: Any, where: str) -> tuple[complex, ...]:
    """Poles in rad/s, real or [re, im]; raises BadInput unless they are two a state, stable and in conjugate pairs."""
    listed = isinstance(entries, list | tuple)
    poles = tuple(_pole(entry, f"{where}[{index}]") for index, entry in enumerate(entries)) if listed else ()
    for pole in poles:
        if pole.imag != 0.0 and poles.count(pole) != poles.count(pole.conjugate()):
            missing = f"its conjugate [{pole.real:g}, {-pole.imag:g}] as often"
            raise BadInput("poles", where, f"[{pole.real:g}, {pole.imag:g}] alone", missing, "write both of the pair")
    most = 2 * ORDERS[-1]
    if len(poles) not in range(2, most + 1, 2):
        raise BadInput(
            "poles",
            where,
            f"{len(poles)} poles" if listed else repr(entries)[:60],
            f"two poles for each state that the input moves and that moves the output, {most} at most",
            f"give plant and controller as many each; of more than {ORDERS[-1]} states leave the fastest out",
        )
    return poles


def read_roll_off(value: Any, where: str) -> float:
    """A real pole, or 0 for none."""
    return _pole(value, where).real if checks.number(value, where) else 0.0


def _pole(entry: Any, where: str) -> complex:
    if isinstance(entry, list | tuple):
        pole = complex(*checks.numbers(entry, where, 2))
    else:
        pole = complex(checks.number(entry, where))
    if pole.real >= 0.0:
        raise BadInput(
            "pole",
            where,
            f"{pole.real:g}{pole.imag:+g}j rad/s, on or outside the unit circle in z",
            "a real part below 0",
            "check its sign: a stable pole is negative",
        )
    return pole
