"""Numbers of a controller that its design leaves open, as [design.tuned.NAME.AXIS] of a plant file states them.

`twinlaw design --controller NAME --tune SEED` finds them by flying the plant (verification/comparison/tuning.py) and writes the section.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from controllers.equations.designing import Points
from records.law_table import LawTable
from records.text import checks

Numbers = Mapping[str, float]


@dataclass(frozen=True)
class OpenNumber:
    """A number and the range in which it is looked for, by its logarithm or, with `linear`, evenly."""

    name: str
    low: float
    high: float
    linear: bool = False


@dataclass(frozen=True)
class Tunable:
    """What a controller leaves open, by axis; its table with such numbers, by axis, and how its C takes an axis' while it is tuned.

    `template` is a file of controllers/templates behind law.c that has `law_tune`, which takes what `flat` makes of the gains.
    """

    open: Mapping[str, tuple[OpenNumber, ...]]
    table: Callable[[Points, Mapping[str, Numbers]], LawTable[Any]]
    template: str
    flat: Callable[[Any], list[float]]


def tuned(points: Points, controller: str, tunable: Tunable) -> dict[str, dict[str, float]] | None:
    """The section's numbers by axis, None where the plant file has none of this controller; raises BadInput for a key amiss."""
    where = f"plant {points.bound.plant.name!r}: design.tuned"
    section = checks.table(points.bound.plant.design.get("tuned", {}), where)
    if controller not in section:
        return None
    mine, where = checks.table(section[controller], f"{where}.{controller}"), f"{where}.{controller}"
    checks.keys(mine, where, tuple(tunable.open))
    return {axis: _numbers(mine[axis], wanted, f"{where}.{axis}") for axis, wanted in tunable.open.items()}


def _numbers(entry: Any, wanted: tuple[OpenNumber, ...], where: str) -> dict[str, float]:
    section, names = checks.table(entry, where), [number.name for number in wanted]
    checks.keys(section, where, names)
    return {
        number.name: (checks.number if number.linear else checks.positive)(
            section[number.name], f"{where}.{number.name}"
        )
        for number in wanted
    }
