"""Where each parameter may lie: from the plant file's values, or as the user says."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from identification.runs.run import coefficient_names
from records.errors import BadInput
from sim.bind import BoundPlant

LEAST_FRICTION = 1e-3  # of its size: dry friction of exactly 0 does not act, and so has no slope that would lead back
FACTOR = 5.0  # by default a parameter lies between a fifth and five times its start


@dataclass(frozen=True)
class Range:
    """Where a parameter may lie, and its typical size."""

    start: float
    lower: float
    upper: float
    scale: float


def ranges_of(
    bound: BoundPlant, names: Sequence[str], limits: Mapping[str, tuple[float, float]] | None = None
) -> dict[str, Range]:
    """A range for each name; a start of 0 takes its size from the plant's other parameters of its kind.

    A parameter that must be positive starts above 0. Raises BadInput for an unknown name, or a start outside `limits`.
    """
    known = coefficient_names(bound.model)
    found = {}
    for name in names:
        if name not in known:
            raise BadInput(
                f"parameter {name!r}", bound.plant.name, "an unknown name", f"one of {', '.join(known)}", "correct it"
            )
        found[name] = _range(bound, name, float(bound.p[known.index(name)]), (limits or {}).get(name))
    return found


def _range(bound: BoundPlant, name: str, start: float, limits: tuple[float, float] | None) -> Range:
    sign = next(spec.sign for spec in bound.model.parameters if name in {str(symbol) for symbol in spec.symbols})
    sd = float(bound.sd[coefficient_names(bound.model).index(name)])
    own = abs(start) if start else _size_of_absent(bound, name)
    size = max(own, sd)  # a guess with a wide sd may be far off
    if limits is None:
        lower, upper = (own / FACTOR, size * FACTOR) if sign == "positive" else (-size * FACTOR, size * FACTOR)
        lower = LEAST_FRICTION * own if sign == "non-negative" else lower
        return Range(max(start, lower), lower, upper, size)
    lower, upper = limits
    if not lower <= start <= upper:
        raise BadInput(
            f"start of {name}",
            bound.plant.name,
            f"{start:g}",
            f"a value between its bounds {lower:g} and {upper:g}",
            "change the plant file or the bounds",
        )
    return Range(start, lower, upper, size)


def _size_of_absent(bound: BoundPlant, name: str) -> float:
    """The size of a parameter that is 0 in the plant file: its sd, else for a polynomial's first coefficient the second at 100 rad/s.

    For any other the product of the model's own scale is not known, and 1 in its unit is taken.
    """
    known = coefficient_names(bound.model)
    sd = float(bound.sd[known.index(name)])
    if sd > 0.0:
        return sd
    if name.endswith("_0") and f"{name[:-2]}_1" in known:
        return abs(float(bound.p[known.index(f"{name[:-2]}_1")])) * 100.0
    return 1.0
