"""Lag of a driver, of a rotor that the model takes as immediate, or of a sensor.

(1)  tau y' = x - y

An input's may be two in a row, as the current of a winding and the speed behind it are, which share the mean time:

(2)  (1 - b) tau w' = u - w,   b tau v' = w - v
"""

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

import sympy

from sim.edits import short, with_output, with_state
from sim.effect import Effect, EffectParameter, FilterState, Role
from sim.model import Model, symbol
from sim.paths.input_stages import Lag
from sim.paths.output_stages import OutputLag
from sim.places import SensorPlace
from sim.prior import COMMON, UNSEEN_LOSSES, Unlikely

LATE = "slow motion shows only the mean time by which both are late"
SAME = "identical: the rotor has no other lag between command and thrust"
THROUGH = "where the plant is linear and nothing disturbs it, a lag before it is one behind it"


def effects(model: Model) -> Iterator[Effect]:
    """Eq (2) on each input and on each rotor without a lag of its own, eq (1) on each sensor."""
    for place, entry in model.places.inputs.items():
        column = model.inputs.index(entry.variable)
        rotor_place = model.places.driven_by(entry.variable)
        immediate = bool(rotor_place) and model.places.rotors[rotor_place].drive is None
        yield _lag(
            column,
            0.02,
            UNSEEN_LOSSES,
            name=f"{place}.lag",
            depends=f"lag of {entry.variable}",
            story="The driver or the motor's winding follows its command with a lag.",
            source="inductance of the winding, L/R",
            twins={f"{place}.delay": LATE} | ({f"{rotor_place}.lag": SAME} if immediate else {}),
        )
        if immediate:
            yield _lag(
                column,
                0.05,
                name=f"{rotor_place}.lag",
                depends=f"lag of thrust({entry.variable})",
                story="The rotor takes its time to reach the speed that the command asks for.",
                source="inertia of the rotor",
                twins={f"{place}.lag": SAME, f"{place}.delay": LATE},
                copy_of=f"{place}.lag",
            )
    before = [f"{place}.lag" for place in (*model.places.inputs, *model.places.rotors)]
    for place, sensor in model.places.sensors.items():
        yield _of_sensor(model, place, sensor, before)


def _lag(column: int, usual_s: float, unlikely: Unlikely | None = None, **told: Any) -> Effect:
    """Eq (2) on the input of this column; `told` are the effect's own name, words and twins."""
    tau = EffectParameter("tau", "s", 0.0, 2.0, usual_s, 0.0, (0.02, 0.1, 0.3), role=Role.LATENESS, unlikely=unlikely)
    # Two equal lags have one answer more than those of a quotient by their difference.
    second = EffectParameter("b", "1", 0.0, 0.45, 0.0, refining=True)
    return Effect(
        parameters=(tau, second),
        equation="(1 - b) tau w' = u - w, b tau v' = w - v, v instead of u",
        prior=COMMON,
        on_input=lambda values: Lag(column, values["tau"], values.get("b", 0.0)),
        **told,
    )


def _of_sensor(model: Model, place: str, sensor: SensorPlace, before: Sequence[str]) -> Effect:
    """Eq (1); `before` are the lags that lie before the plant."""
    output = [*model.outputs].index(sensor.output)
    state = f"{sensor.output}_read"
    return Effect(
        name=f"{place}.lag",
        depends=f"lag of {short(sensor.output)}",
        parameters=(EffectParameter("tau", "s", 0.0, 1.0, 0.015, 0.0, (0.01, 0.05, 0.15), role=Role.LATENESS),),
        equation="tau y' = angle - y",
        story="The reading is smoothed and so comes late.",
        source="a sensor's filter",
        prior=COMMON,
        filter_state=FilterState(state, partial(_read_late, state, sensor.output), follows=sensor.output),
        on_output=lambda values: OutputLag(output, values["tau"]),
        twins={f"{place}.delay": LATE, "loop.delay": LATE} | dict.fromkeys(before, THROUGH),
    )


def _read_late(state: str, output: str, model: Model, on: sympy.Symbol, tau: sympy.Symbol) -> Model:
    """Eq (1) as a state of the equations, which is read in place of the output: so a filter's gains know of it."""
    late, y = symbol(state), sympy.sympify(model.outputs[output])
    model = with_state(model, late, (y - late) / tau)
    return with_output(model, output, lambda _: y + on * (late - y))
