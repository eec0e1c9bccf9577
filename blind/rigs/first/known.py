"""The first rig's rows of the contract's table, in other formulations than the library's; their C stands in `c/`."""

import numpy as np

from blind.effects.ce150_formulas import LOWER_STOP_RAD, OwnLaw, flexible_mode
from blind.effects.ce150_table import for_both, in_table
from blind.effects.draws import Uniform
from blind.effects.effect import Effect, Shape, Size, over
from blind.effects.equivalent import PHASES, Equivalents, relative
from blind.effects.visited import Array, Visited

WIDE = (0.003, 10.0)
COULOMB_NM = (2.0e-4, 3.0e-4)
LIMIT_V, LIMIT_BOUNDS = (7.6, 4.0), ((0.8, 1.28), (0.6, 1.7))
SPIN_KG_M2 = (2e-5, 1e-5)
GRAVITY_NM = 0.0383


def _input_rows(i: int) -> tuple[Effect, ...]:
    """Effects between the command and the voltage of rotor i."""

    def rounded_knees(a: float, shape: Shape, visited: Visited) -> Array:
        u = visited.u(i)
        w = shape["dead_width"] * a
        return np.asarray(np.sign(u) * w * (np.logaddexp(0.0, (np.abs(u) - a) / w) - np.log1p(np.exp(-a / w))))

    def rounded_corner(a: float, shape: Shape, visited: Visited) -> Array:
        u = visited.u(i)
        return np.asarray(u / (1.0 + (u / a) ** 12) ** (1.0 / 12.0))

    return (
        in_table(
            "{rotor}_input.deadzone",
            Size("dead_V", 0.2),
            i,
            drawn={"dead_width": Uniform(0.1, 0.35)},
            bounds=(0.01, 8.0),
            law=OwnLaw(rounded_knees),
        ),
        in_table(
            "{rotor}_input.saturation",
            Size("limit_V", LIMIT_V[i], over),
            i,
            bounds=LIMIT_BOUNDS[i],
            law=OwnLaw(rounded_corner, lambda a, shape, target: [0.97 * a]),
        ),
        in_table("{rotor}_input.supply_sag", Size("sag", 0.03), i, bounds=(0.003, 8.0)),
        in_table("{rotor}_input.delay", Size("delay_s", 0.01), i, bounds=(0.1, 8.0)),
        in_table("{rotor}_input.slew_limit", Size("slew_V_s", 10.0, over), i, bounds=(0.05, 12.0)),
        in_table("{rotor}_input.quantization", Size("step_V", 0.2), i, bounds=(0.05, 6.0)),
        in_table("{rotor}_input.lag", Size("lag_s", 0.02), i, bounds=(0.05, 8.0)),
    )


def _resistance(a: float, shape: Shape, visited: Visited) -> Array:
    """The winding's resistance grows here; the library lets the drive fall."""
    return np.asarray(1.0 - 1.0 / (1.0 + a * (1.0 - np.exp(-visited.t_s / shape["warm_time_s"]))))


def _rotor_rows(i: int) -> tuple[Effect, ...]:
    return (
        in_table(
            "{rotor}_rotor.warmup",
            Size("warm", 0.03),
            i,
            drawn={"warm_time_s": Uniform(8.0, 40.0)},
            bounds=WIDE,
            law=OwnLaw(_resistance, lambda a, shape, target: [a, shape["warm_time_s"]]),
        ),
        in_table("{rotor}_rotor.dry_friction", Size("dry", 30.0), i, bounds=WIDE),
    )


def _mode(m: float, shape: Shape, visited: Visited) -> Equivalents:
    """The encoder sits behind a light spring."""
    return flexible_mode(shape["flex_rad_s"], shape["flex_zeta"])


def _axis_rows(i: int) -> tuple[Effect, ...]:
    def exponential(a: float, shape: Shape, visited: Visited) -> Array:
        return np.asarray(a * np.exp(-np.abs(visited.rate(i)) / shape["stribeck_rad_s"]))

    def laminar_below(a: float, shape: Shape, visited: Visited) -> Array:
        v = visited.rate(i)
        return np.asarray(a * v * np.hypot(v, shape["drag_floor_rad_s"]))

    def stiffening(a: float, shape: Shape, visited: Visited) -> Array:
        x = visited.angle(i) - shape["spring_zero_rad"]
        return np.asarray(-a * x * (1.0 + shape["hardening"] * x * x))

    return (
        in_table("{axis}.coulomb", Size("", COULOMB_NM[i]), i, bounds=WIDE, hides=("b_cE", "b_cA")[i]),
        in_table(
            "{axis}.stribeck",
            Size("stribeck_Nm", 4e-4),
            i,
            drawn={"stribeck_rad_s": Uniform(0.03, 0.15)},
            bounds=WIDE,
            law=OwnLaw(exponential, lambda a, shape, target: [a, shape["stribeck_rad_s"]]),
        ),
        in_table(
            "{axis}.quadratic_drag",
            Size("drag", 1.5e-3),
            i,
            drawn={"drag_floor_rad_s": Uniform(0.02, 0.1)},
            bounds=WIDE,
            law=OwnLaw(laminar_below),
        ),
        in_table(
            "{axis}.cable_spring",
            Size("spring", 2e-3),
            i,
            drawn={"spring_zero_rad": Uniform(-0.4, 0.4), "hardening": Uniform(0.0, 0.4)},
            bounds=WIDE,
            law=OwnLaw(stiffening),
        ),
        in_table("{axis}.rotor_acceleration", Size("spin_inertia", SPIN_KG_M2[i]), i, signed=i == 0, bounds=WIDE),
        in_table(
            "{axis}.disturbance",
            Size("pulse_Nm", 3e-3),
            i,
            signed=True,
            drawn={"pulse_start_s": Uniform(6.0, 18.0), "pulse_s": Uniform(0.5, 3.0)},
            bounds=WIDE,
            law=OwnLaw(lambda a, shape, visited: np.asarray(a * np.sqrt(np.sin(np.pi * PHASES)))),
        ),
        in_table(
            "{axis}.flexible_mode",
            Size("flex", 0.3),
            i,
            drawn={"flex_rad_s": Uniform(15.0, 45.0), "flex_zeta": Uniform(0.03, 0.1)},
            bounds=(0.05, 3.5),
            equivalent=_mode,
        ),
    )


def _sensor_rows(i: int) -> tuple[Effect, ...]:
    """An offset of the azimuth is left out: nothing depends on where azimuth's zero is."""
    offset = in_table("{angle}_sensor.offset", Size("offset_rad", 0.02), i, signed=True, bounds=(0.02, 5.0))
    return (
        *((offset,) if i == 0 else ()),
        in_table("{angle}_sensor.scale", Size("scale_error", 0.03), i, signed=True, bounds=(0.02, 6.0)),
        in_table("{angle}_sensor.quantization", Size("count_rad", 0.006), i, bounds=(0.5, 6.0)),
        in_table("{angle}_sensor.delay", Size("sensor_delay_s", 0.01), i, bounds=(0.1, 6.0)),
        in_table("{angle}_sensor.lag", Size("sensor_lag_s", 0.015), i, bounds=(0.05, 6.0)),
        in_table("{angle}_sensor.backlash", Size("backlash_rad", 0.006), i, bounds=(0.3, 6.0)),
    )


def _image_rotor(a: float, shape: Shape, visited: Visited) -> Array:
    """Inverse square of the height."""
    height = shape["ground_height_rad"]
    return np.asarray(a * (height / (height + (visited.psi - LOWER_STOP_RAD))) ** 2)


def _turned_gravity(m: float, shape: Shape, visited: Visited) -> Equivalents:
    """tau sin(delta) sin(psi) beside an unchanged cosine here; the library turns the whole gravity torque by delta."""
    return {"delta": relative(np.arcsin(0.05 * m * shape["sign"]))}


AIR = (
    in_table(
        "main_rotor.ground_effect",
        Size("ground", 0.05),
        drawn={"ground_height_rad": Uniform(0.25, 0.6)},
        bounds=WIDE,
        law=OwnLaw(_image_rotor, lambda a, shape, target: [a, shape["ground_height_rad"]]),
    ),
    in_table(
        "tail_rotor.reverse_asymmetry",
        Size("reverse", -0.15),
        signed=True,
        drawn={"reverse_width_rad_s": Uniform(5.0, 30.0)},
        bounds=(0.05, 5.0),
    ),
    in_table(
        "tail_rotor.downwash",
        Size("downwash", 0.05),
        bounds=WIDE,
        law=OwnLaw(lambda a, shape, visited: np.asarray(1.0 - 1.0 / (1.0 + a * (visited.omega_M / 600.0)))),
    ),
)
ONE_AXIS = (
    in_table(
        "elevation.centre_of_gravity",
        Size("centre_Nm", GRAVITY_NM * 0.05),
        signed=True,
        bounds=WIDE,
        equivalent=_turned_gravity,
    ),
    in_table(
        "elevation.weight_shift",
        Size("weight", 0.02),
        signed=True,
        drawn={"weight_time_s": Uniform(6.0, 18.0), "weight_ramp_s": Uniform(0.05, 0.3)},
        bounds=WIDE,
    ),
    in_table(
        "elevation.tail_coupling",
        Size("tail_to_elevation_m", 0.01),
        signed=True,
        bounds=WIDE,
        law=OwnLaw(lambda a, shape, visited: a * visited.tail_thrust(visited.omega_T)),
    ),
    in_table("azimuth.tilt", Size("tilt_Nm", 2e-3), drawn={"tilt_rad": Uniform(-np.pi, np.pi)}, bounds=WIDE),
    in_table("azimuth.gyroscopic", Size("gyro_azimuth", 2e-5), bounds=(0.01, 20.0)),
    in_table("azimuth.friction_asymmetry", Size("asymmetry_Nm", 2e-4), 1, signed=True, bounds=(0.01, 2.0)),
)
LOOP = (
    in_table("loop.delay", Size("delay_s", 0.01), 0, 1, bounds=(0.1, 6.0)),
    in_table("loop.dropped_frames", Size("", 0.1, most=0.6), bounds=(0.05, 5.0), loses_frames=True),
)
KNOWN = (*for_both(_input_rows, _rotor_rows, _axis_rows, _sensor_rows), *AIR, *ONE_AXIS)
