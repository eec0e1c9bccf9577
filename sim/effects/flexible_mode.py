"""A springy part between the driven axis and its encoder.

    (1)  y = angle + gain d,   d' = w - angle',   w' = -omega_n^2 d - 2 zeta omega_n d'

d is how far a light part on a spring lags behind the axis; gain = 1 measures that part alone.
"""

from collections.abc import Iterator

import sympy

from sim.edits import axis_of, with_output, with_state
from sim.effect import Effect, EffectParameter
from sim.model import Model, symbol
from sim.prior import COMMON


def effects(model: Model) -> Iterator[Effect]:
    """Eq (1) on each axis whose angle is measured."""
    for axis, entry in model.places.axes.items():
        if entry.angle not in model.outputs:
            continue
        yield Effect(
            name=f"{axis}.flexible_mode",
            depends="mode(torque)",
            parameters=(
                EffectParameter("gain", "-", -3.0, 3.0, 0.3, 0.0),
                EffectParameter("omega_n", "rad s^-1", 5.0, 150.0, 30.0, starts=(15.0, 25.0, 40.0, 80.0)),
                EffectParameter("zeta", "-", 0.003, 1.0, 0.05),
            ),
            equation="y = angle + gain d, d'' + 2 zeta omega_n d' + omega_n^2 d = - angle''",
            story="Between the axis and its sensor something is springy and rings after every jolt.",
            source="two masses and a spring",
            prior=COMMON,
            edit=lambda model, gain, omega_n, zeta, axis=axis: _edit(model, gain, omega_n, zeta, axis),
            twins=_twins(model, axis),
        )


def _twins(model: Model, axis: str) -> dict[str, str]:
    entry = model.places.axes[axis]
    read = [place for place, sensor in model.places.sensors.items() if sensor.output == entry.angle]
    late = dict.fromkeys(
        (f"{place}.lag" for place in (*read, *model.places.inputs)), "a slow part of gain 1 reads late"
    )
    return late | ({f"{axis}.rotor_acceleration": "both answer to fast changes of the drive"} if entry.spun_by else {})


def _edit(model: Model, gain: sympy.Symbol, omega_n: sympy.Symbol, zeta: sympy.Symbol, axis: str) -> Model:
    entry, velocity = model.places.axes[axis], axis_of(model, axis).velocity
    d, w = symbol(f"mode_{axis}_{entry.length_unit}"), symbol(f"mode_{axis}_{entry.length_unit}_s")
    rate = w - velocity
    model = with_state(model, d, rate)
    model = with_state(model, w, -(omega_n**2) * d - 2 * zeta * omega_n * rate, velocity)
    return with_output(model, entry.angle, lambda output: output + gain * d)
