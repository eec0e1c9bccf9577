"""Which plants the design stage can work on: a helicopter of two axes as the CE150 is one, by the names of its columns."""

from collections.abc import Iterator

from design.linearise import SUBSYSTEMS
from records.errors import BadInput
from sim.bind import BoundPlant

PARAMETERS = (
    "Psi_lim",
    "Phi_lim",
    "u_min",
    "u_max",
    "uT_min",
    "uT_max",
)  # stops and limits, which table and references keep


def missing(bound: BoundPlant) -> tuple[str, ...]:
    """What a plant lacks to be designed for, in words; nothing of one that has the helicopter's structure."""
    return tuple(_missing(bound))


def demand_helicopter(bound: BoundPlant) -> None:
    """Raise BadInput naming what the plant's equations lack to be designed for."""
    lacking = missing(bound)
    if lacking:
        got = f"the equations of {bound.plant.model}, without {', '.join(lacking[:4])}{' and more' if len(lacking) > 4 else ''}"
        expected = "a helicopter with elevation and azimuth, as model ce150 has them"
        remedy = (
            "give such a plant; `simulate` without a loop, `identify`, `diagnose` and `watch` of a log take every plant"
        )
        raise BadInput("plant to design for", f"plant {bound.plant.name!r}", got, expected, remedy)


def _missing(bound: BoundPlant) -> Iterator[str]:
    model = bound.nominal
    wanted = {
        "input": [part.input for part in SUBSYSTEMS.values()],
        "output": [part.output for part in SUBSYSTEMS.values()],
    }
    for kind, names in wanted.items():
        found = [str(name) for name in (model.inputs if kind == "input" else model.outputs)]
        if found != names:
            yield from (f"the {kind} {name}" for name in names if name not in found)
            if set(names) <= set(found):
                yield f"{kind}s {' and '.join(names)} alone, in this order"
    states = {str(state) for state in model.states}
    yield from (f"the state {name}" for part in SUBSYSTEMS.values() for name in part.states if name not in states)
    yield from (f"the axis {axis}" for axis in SUBSYSTEMS if axis not in {entry.name for entry in model.axes})
    yield from (f"the parameter {name}" for name in PARAMETERS if name not in bound.plant.parameters)
