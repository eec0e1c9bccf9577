"""The real rigs' effects, plant by plant: names of the library, formulas of their own whose C stands in `c/`.

Sizes go by what is usual on a plant: an input's size, an axis' torque, rate and reach.
"""

from collections.abc import Callable, Mapping
from functools import partial

from blind.effects import ce150_formulas as formulas
from blind.effects import row
from blind.effects.ce150_formulas import Formula, OwnLaw
from blind.effects.draws import Fixed, OneOf, Uniform
from blind.effects.effect import Catalogue, Effect, Size, over
from blind.effects.equivalent import below_largest, relative
from blind.effects.visited import Visited
from blind.rigs.real import beyond
from blind.rigs.real import formulas as own
from blind.rigs.real.plant import RealPlant
from blind.rigs.real.plants import CE150, PLANTS

known = partial(row.known, bounds=beyond.BOUNDS)


def _inputs(p: RealPlant, i: int) -> tuple[Effect, ...]:
    """Between the command and the voltage of a motor."""
    at, u, size = p.drives[i], p.inputs[i], p.input_V[i]
    lag = f"{p.rotors[i]}.lag" if p.rotors and not p.speeds else ""
    sag = known(
        f"{at}.supply_sag", f"gain({u}) of {u}", Size("sag", 0.03 * 10.0 / size), formulas.supply_sag, i, law=OwnLaw(own.sagging)
    )  # fmt: skip
    return (
        known(
            f"{at}.deadzone", f"dead band of {u}", Size("dead_V", 0.025 * size), formulas.dead_zone, i,
            law=OwnLaw(own.dead_band(i)), drawn={"dead_bend": Uniform(0.05, 0.25)},
        ),
        known(
            f"{at}.saturation", f"limit of {u}", Size("limit_V", p.busy * size, over), formulas.saturation, i,
            law=OwnLaw(own.soft_limit(i), below_largest), drawn={"limit_power": Uniform(8.0, 20.0)}, bounds=(0.6, min(8.0, p.severest)),
        ),
        *((sag,) if u.endswith("_V") else ()),
        known(
            f"{at}.slew_limit", f"rate limit of {u}", Size("slew_V_s", 0.8 * size, over), formulas.same("r"), i,
            bounds=(0.03, p.severest),
        ),
        known(
            f"{at}.quantization", f"steps of {u}", Size("step_V", 0.02 * size), formulas.same("q"), i,
            drawn={"step_phase": Uniform(-0.2, 0.2)}, bounds=(0.03, 10.0),
        ),
        known(
            f"{at}.lag", f"lag of {u}", Size("lag_s", 0.02), formulas.same("tau"), i,
            drawn={"lag_skew": Uniform(-0.2, 0.2)}, bounds=(0.05, 8.0), twins=lag or p.behind("lag"),
        ),
        known(
            f"{at}.delay", f"delay of {u}", Size("delay_s", 0.012), formulas.same("tau"), i, bounds=(0.1, 8.0), twins=p.behind("delay"),
        ),
    )  # fmt: skip


def _drives(p: RealPlant, i: int) -> tuple[Effect, ...]:
    """Motors with what they turn; where thrust is stated as proportional it may be another power, and where it has a sign it may be weaker
    one way."""
    if not p.rotors:
        return ()
    at, u, size = p.rotors[i], p.inputs[i], p.input_V[i]
    warm = known(
        f"{at}.warmup", f"gain(t) of {u}", Size("warm", 0.05), formulas.warm_up, i,
        law=OwnLaw(own.warming, own.warm_start), drawn={"warm_s": Uniform(2.0, 8.0)}, bounds=(0.01, 12.0),
    )  # fmt: skip
    if p.speeds:
        dry = known(
            f"{at}.dry_friction", f"torque(sgn omega_{'MT'[i]}) on rotor", Size("dry", 30.0), formulas.dry_rotor, i,
            law=OwnLaw(own.rounded_dry(i)),
        )  # fmt: skip
        return warm, dry
    if p.signed:
        weak = known(
            f"{at}.reverse_asymmetry", f"thrust(sgn {u})", Size("reverse", 0.1, most=0.9), own.reversed_command, i,
            twins=f"{p.drives[i]}.driver_asymmetry", bounds=(0.02, 6.0),
        )  # fmt: skip
        return warm, weak
    if not p.proportional:
        return (warm,)
    square = known(
        f"{at}.quadratic_thrust", f"thrust({u})", Size("power", 0.15), own.quadratic_thrust, i,
        fixed={"power_V": size}, bounds=(0.02, 6.0),
    )  # fmt: skip
    return warm, square


def _axes(p: RealPlant, i: int) -> tuple[Effect, ...]:
    at, angle, torque = p.axes[i], p.angles[i], p.torque[i]
    rate, reach = p.rate[i], p.reach[i]
    uneven = known(
        f"{at}.friction_asymmetry", f"torque(sgn {angle}_dot) on {at}", Size("asymmetry", 0.01 * torque),
        formulas.same("difference", either_sign=True), i, signed=True,
    )  # fmt: skip
    dry = (
        known(f"{at}.coulomb", f"torque(sgn {angle}_dot) on {at}", Size("", 0.0075 * torque), formulas.same("b"), i, hides=p.hides[i])
        if p.hides
        else known(f"{at}.coulomb", f"torque(sgn {angle}_dot) on {at}", Size("coulomb", 0.0075 * torque), formulas.same("b"), i)
    )  # fmt: skip
    return (
        dry,
        known(
            f"{at}.stribeck", f"torque({angle}_dot) on {at}", Size("stribeck", 0.0125 * torque), formulas.stribeck, i,
            law=OwnLaw(own.tustin(i), lambda a, shape, target: [a, 1.5 * shape["stribeck_rate"]]),
            drawn={"stribeck_rate": Uniform(0.05 * rate, 0.2 * rate)},
        ),
        known(
            f"{at}.quadratic_drag", f"torque({angle}_dot) on {at}", Size("drag", 0.05 * torque / rate**2),
            formulas.quadratic_drag, i, law=OwnLaw(own.saturating_drag(i)), drawn={"drag_rate": Uniform(4.0 * rate, 12.0 * rate)},
        ),
        known(
            f"{at}.cable_spring", f"torque({angle}) on {at}", Size("spring", 0.03 * torque / reach), formulas.cable_spring, i,
            law=OwnLaw(own.hard_spring(i)),
            drawn={"spring_hard": Uniform(0.1 / reach, 0.6 / reach), "spring_zero": Uniform(-0.3 * reach, 0.3 * reach)},
        ),
        known(
            f"{at}.disturbance", f"torque(t) on {at}", Size("pulse", 0.1 * torque), formulas.disturbance, i, law=OwnLaw(own.blunt_push),
            drawn={"pulse_start_s": Uniform(3.0, 9.0), "pulse_s": Uniform(0.4, 2.5)}, signed=True,
        ),
        *((uneven,) if p.uneven else ()),
    )  # fmt: skip


def _sensors(p: RealPlant, i: int) -> tuple[Effect, ...]:
    """An offset is left out where nothing depends on where the angle's zero is, a scale where the plant's own numbers scale the angle."""
    at, output, reach = p.sensors[i], p.angles[i], p.fine(i)
    offset = known(
        f"{at}.offset", f"offset of {output}", Size("offset", 0.06 * reach), formulas.sensor_offset, i,
        signed=True, sensor=True, bounds=(0.02, 8.0),
    )  # fmt: skip
    scale = known(
        f"{at}.scale", f"scale of {output}", Size("scale_error", 0.04), formulas.sensor_scale, i, signed=True, sensor=True,
        bounds=(0.02, 6.0),
    )  # fmt: skip
    return (
        *((offset,) if p.gravity == p.axes[i] else ()),
        *((scale,) if not p.linear else ()),
        known(
            f"{at}.quantization", f"quantization of {output}", Size("count", 0.02 * reach), formulas.same("q"), i, sensor=True,
            bounds=(0.01, 8.0),
        ),
        known(
            f"{at}.delay", f"delay of {output}", Size("sensor_delay_s", 0.012), formulas.same("tau"), i, sensor=True,
            bounds=(0.1, 7.0), twins=p.before("delay"),
        ),
        known(
            f"{at}.lag", f"lag of {output}", Size("sensor_lag_s", 0.015), formulas.same("tau"), i, sensor=True, bounds=(0.05, 8.0),
            twins=p.before("lag"),
        ),
        known(
            f"{at}.backlash", f"backlash of {output}", Size("backlash", 0.02 * reach), formulas.same("width"), i, sensor=True,
            bounds=(0.02, 8.0),
        ),
    )  # fmt: skip


def _shift(moment: Callable[[Visited], float]) -> Formula:
    """A step of gravity's torque, at the middle of the time that the weight takes."""
    return lambda e: {"Delta": relative(e.a * moment(e.visited))}


def _weights(p: RealPlant) -> tuple[Effect, ...]:
    """Of the axis that gravity turns."""
    at = p.gravity
    angle = p.angles[p.axes.index(at)]
    return (
        known(
            f"{at}.centre_of_gravity", f"torque({angle}) on {at}", Size("centre_rad", 0.06), formulas.same("delta"), signed=True
        ),
        known(
            f"{at}.weight_shift", f"torque(t) on {at}", Size("weight", 0.025), _shift(lambda v: v.gravity_Nm), signed=True,
            drawn={"weight_time_s": Uniform(3.0, 9.0)},
        ),
    )  # fmt: skip


CE150_ALONE = (
    known(
        "main_rotor.ground_effect", "thrust(psi)", Size("ground", 0.06), formulas.ground_effect,
        law=OwnLaw(own.near_ground, lambda a, shape, target: [a, shape["ground_rad"]]), drawn={"ground_rad": Uniform(0.25, 0.6)},
    ),
    known(
        "tail_rotor.downwash", "thrust(omega_M)", Size("downwash", 0.08), formulas.downwash, law=OwnLaw(own.washed),
        drawn={"downwash_bend": Uniform(0.5, 1.5)}, bounds=(0.003, 8.0),
    ),
    known(
        "elevation.tail_coupling", "torque(omega_T) on elevation", Size("tail_lift", 2e-8), formulas.tail_coupling,
        law=OwnLaw(own.tail_lift), signed=True,
    ),
    known(
        "azimuth.tilt", "torque(phi) on azimuth", Size("tilt", 3e-3), formulas.tilt, drawn={"tilt_rad": Uniform(-3.14, 3.14)}
    ),
    known(
        "azimuth.gyroscopic", "torque(psi_dot, omega_M, psi) on azimuth", Size("gyro_azimuth", 3e-5), formulas.gyroscopic
    ),
)  # fmt: skip


def _loop(p: RealPlant) -> tuple[Effect, ...]:
    inputs = " and ".join(p.inputs)
    every = tuple(range(len(p.inputs)))
    one = p.drives[0]
    return (
        known(
            "loop.delay", f"delay of {inputs}", Size("delay_s", 0.012), formulas.same("tau"), *every, bounds=(0.1, 8.0),
            twins=f"{one}.delay {p.behind('delay')}" if len(every) == 1 else "",
        ),
        known(
            "loop.dropped_frames", f"lost updates of {inputs}", Size("", 0.1, most=0.6), formulas.same("p"),
            drawn={"burst_frames": OneOf(Fixed(1.0), Uniform(2.0, 6.0))}, bounds=(0.05, 6.0), loses_frames=True,
        ),
    )  # fmt: skip


def _catalogue(p: RealPlant) -> Catalogue:
    axes, inputs = range(len(p.axes)), range(len(p.inputs))
    rows = [row for i in inputs for row in (*_inputs(p, i), *_drives(p, i))]
    rows += [row for i in axes for row in (*_axes(p, i), *_sensors(p, i))]
    rows += _weights(p) if p.gravity else ()
    rows += CE150_ALONE if p is CE150 else ()
    further = [row for i in axes for row in (*beyond.of_axis(p, i), *beyond.of_sensor(p, i))]
    further += [row for i in inputs for row in beyond.of_drive(p, i)]
    return Catalogue(tuple(rows), _loop(p), tuple(further))


CATALOGUES: Mapping[str, Catalogue] = {plant.name: _catalogue(plant) for plant in PLANTS}
ALL = tuple(effect for catalogue in CATALOGUES.values() for effect in catalogue.all)
