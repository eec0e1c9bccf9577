"""What is known to be true beside what was found: truth, error, and the error in standard deviations, z."""

from collections.abc import Mapping

from records.text.uncertain import to_sd
from sim.bind import BoundPlant

HEADING = ("truth", "error", "z")


def true_values(truth: BoundPlant | None) -> Mapping[str, float]:
    """The true coefficients by name; none where no truth is known."""
    if truth is None:
        return {}
    return dict(zip(map(str, truth.model.parameter_symbols), truth.p.tolist(), strict=True))


def told(known: float | None, sd: float) -> str:
    """A true value to the place of the estimate beside it, whose `sd` it is; empty where it is not known."""
    return "" if known is None else to_sd(known, sd)


def off(value: float, known: float | None, unit: str) -> str:
    """How far a value is from the truth, in per cent of that; in its `unit` where the truth is zero."""
    if known is None:
        return ""
    return f"{100.0 * (value / known - 1.0):+.2f} %" if known else f"{value:+.3g} {unit}".rstrip()


def z(value: float, sd: float, known: float | None) -> str:
    """The same in standard deviations."""
    return "" if known is None or sd <= 0.0 else f"{(value - known) / sd:+.1f}"
