"""Transport delay of a command, of all commands, or of a reading.

(1)  u(t - tau),   y(t - tau - d_n),   d_n even, of standard deviation `jitter`, drawn anew for each sample n
"""

from collections.abc import Iterator
from dataclasses import replace

from sim.edits import short
from sim.effect import Effect, EffectParameter, Role
from sim.model import Model
from sim.paths.input_stages import Delay
from sim.paths.output_stages import OutputDelay
from sim.prior import COMMON, UNSEEN_LOSSES

LATE = EffectParameter("tau", "s", 0.0, 0.5, 0.01, 0.0, (0.005, 0.02, 0.05), role=Role.LATENESS)
THROUGH = "in a loop on the angle, being late is the same before and behind the plant"
JITTER = EffectParameter("jitter", "s", 0.0, 0.1, 0.0, None, (0.0, 1e-3), refining=True, role=Role.JITTER)


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each input, on all together, and on each sensor."""
    inputs = model.places.inputs
    for column, (place, entry) in enumerate(inputs.items()):
        yield _input_delay(place, f"delay of {entry.variable}", (column,), _twins(model, place))
    if inputs:
        names = " and ".join(str(entry.variable) for entry in inputs.values())
        story = (
            "identical: the loop's delay is that of all inputs"
            if len(inputs) == 1
            else "together they are the loop's delay"
        )
        delays = {f"{place}.delay": story for place in inputs}
        only = next(iter(delays)) if len(inputs) == 1 else ""
        yield _input_delay("loop", f"delay of {names}", tuple(range(len(inputs))), delays, only)
    for place, sensor in model.places.sensors.items():
        output = [*model.outputs].index(sensor.output)
        yield Effect(
            name=f"{place}.delay",
            depends=f"delay of {short(sensor.output)}",
            parameters=(LATE, JITTER),
            equation="y(t) = angle(t - tau - d), d even about 0, of standard deviation jitter, anew for each reading",
            story="The reading is old when it arrives.",
            source="transport delay",
            prior=COMMON,
            on_output=lambda values, output=output: OutputDelay(
                output, values["tau"], values["jitter"], seed=output + 1
            ),
            twins={
                f"{place}.lag": "slow motion shows only the mean time by which both are late",
                **dict.fromkeys(["loop.delay", *(f"{before}.delay" for before in inputs)], THROUGH),
            },
        )


def _input_delay(
    place: str, depends: str, columns: tuple[int, ...], twins: dict[str, str], copy_of: str = ""
) -> Effect:
    return Effect(
        name=f"{place}.delay",
        depends=depends,
        parameters=(replace(LATE, unlikely=UNSEEN_LOSSES),),
        equation="u(t - tau)",
        story="The command takes a while to arrive.",
        source="transport delay",
        prior=COMMON,
        on_input=lambda values: Delay(columns, values["tau"]),
        twins=twins,
        copy_of=copy_of,
    )


def _twins(model: Model, place: str) -> dict[str, str]:
    one = len(model.places.inputs) == 1
    return {
        f"{place}.lag": "slow motion shows only the mean time by which both are late",
        "loop.delay": "identical: there is only one input"
        if one
        else "the loop's delay is that of all inputs together",
    }
