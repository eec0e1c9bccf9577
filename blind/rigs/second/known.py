"""The second rig's rows of the contract's table, in formulas of its own; their C stands in `c/`."""

import numpy as np

from blind.effects.ce150_formulas import OwnLaw, flexible_mode
from blind.effects.ce150_table import for_both, in_table
from blind.effects.draws import Fixed, OneOf, Uniform
from blind.effects.effect import Effect, Shape, Size, over, over_root
from blind.effects.equivalent import Equivalents, below_largest
from blind.effects.visited import Visited
from blind.rigs.second import formulas

WIDE, AXIS_BOUNDS = (0.003, 10.0), (0.01, 10.0)
COULOMB_NM = (3e-4, 4e-4)
LIMIT_V, LIMIT_BOUNDS = (7.2, 4.2), ((0.7, 1.22), (0.5, 1.9))
SPIN_KG_M2 = (4e-5, 1.5e-5)
LATE = {"delay_spread": Uniform(0.0, 0.25)}  # a delay that is never quite the same
MODE = Size("mass_rad_s", 30.0, over_root)


def _input_rows(i: int) -> tuple[Effect, ...]:
    """Effects between the command and the voltage of rotor i."""
    return (
        in_table(
            "{rotor}_input.deadzone",
            Size("dead_V", 0.25),
            i,
            drawn={"dead_knee": Uniform(0.1, 0.5), "dead_skew": Uniform(-0.15, 0.15)},
            bounds=(0.01, 8.0),
            law=OwnLaw(formulas.dead_band(i)),
        ),
        in_table(
            "{rotor}_input.saturation",
            Size("limit_V", LIMIT_V[i], over),
            i,
            drawn={"limit_knee": Uniform(0.03, 0.15)},
            bounds=LIMIT_BOUNDS[i],
            law=OwnLaw(formulas.soft_limit(i), below_largest),
        ),
        in_table(
            "{rotor}_input.supply_sag",
            Size("sag", 0.03),
            i,
            drawn={"supply_s": Uniform(0.02, 0.15)},  # its capacitor
            single=("supply_s",),
            bounds=(0.01, 12.0),
            law=OwnLaw(formulas.inner_resistance),
        ),
        in_table("{rotor}_input.delay", Size("delay_s", 0.012), i, drawn=LATE, bounds=(0.1, 8.0)),
        in_table(
            "{rotor}_input.slew_limit",
            Size("slew_V_s", 8.0, over),
            i,
            drawn={"slew_skew": Uniform(-0.12, 0.12)},
            bounds=(0.05, 12.0),
        ),
        in_table(
            "{rotor}_input.quantization",
            Size("step_V", 0.25),
            i,
            drawn={"step_hold": Uniform(0.05, 0.2)},
            bounds=(0.05, 8.0),
        ),
        in_table(
            "{rotor}_input.lag", Size("lag_s", 0.02), i, drawn={"lag_split": Uniform(0.6, 0.9)}, bounds=(0.05, 6.0)
        ),
    )


def _rotor_rows(i: int) -> tuple[Effect, ...]:
    return (
        in_table(
            "{rotor}_rotor.warmup",
            Size("warm", 0.05),
            i,
            drawn={
                "warm_fast_s": Uniform(3.0, 8.0),
                "warm_slow_s": Uniform(15.0, 40.0),
                "warm_share": Uniform(0.2, 0.8),
            },
            bounds=WIDE,
            law=OwnLaw(formulas.two_masses_warm, formulas.warm_start),
        ),
        in_table(
            "{rotor}_rotor.dry_friction",
            Size("dry", 30.0),
            i,
            drawn={"dry_round_rad_s": Uniform(1.0, 5.0)},
            bounds=WIDE,
            law=OwnLaw(formulas.break_away(i)),
        ),
    )


def _bearing_rows(i: int) -> tuple[Effect, ...]:
    """Which law makes dry friction of them is the rig's."""
    return (
        in_table("{axis}.coulomb", Size("", COULOMB_NM[i]), i, bounds=(0.03, 12.0), hides=("b_cE", "b_cA")[i]),
        in_table(
            "{axis}.stribeck",
            Size("stribeck_Nm", 5e-4),
            i,
            drawn={"stribeck_rad_s": Uniform(0.03, 0.12)},
            bounds=(0.02, 12.0),
            law=OwnLaw(formulas.hyperbola(i), lambda a, shape, target: [a, 1.5 * shape["stribeck_rad_s"]]),
        ),
    )


def _mode(m: float, shape: Shape, visited: Visited) -> Equivalents:
    """Two masses: the arm with the rotors, a spring, the hub with bearing and encoder."""
    return flexible_mode(MODE.at(m), shape["mass_zeta"])


def _axis_rows(i: int) -> tuple[Effect, ...]:
    return (
        in_table(
            "{axis}.quadratic_drag",
            Size("drag", 2e-3),
            i,
            drawn={"drag_power": OneOf(Uniform(1.75, 1.9), Uniform(2.1, 2.3))},
            bounds=AXIS_BOUNDS,
            law=OwnLaw(formulas.other_power(i)),
        ),
        in_table(
            "{axis}.cable_spring",
            Size("spring", 3e-3),
            i,
            drawn={
                "spring_slack": Uniform(0.6, 1.0),
                "spring_growth": Uniform(0.0, 0.3),
                "spring_zero_rad": Uniform(-0.4, 0.4),
            },
            bounds=AXIS_BOUNDS,
            law=OwnLaw(formulas.tether(i)),
        ),
        in_table(
            "{axis}.rotor_acceleration",
            Size("spin_inertia", SPIN_KG_M2[i]),
            i,
            signed=i == 0,
            drawn={"spin_soft_s": Uniform(0.004, 0.015)},  # the mount gives a little
            bounds=AXIS_BOUNDS,
        ),
        in_table(
            "{axis}.disturbance",
            Size("pulse_Nm", 4e-3),
            i,
            signed=True,
            drawn={"pulse_start_s": Uniform(5.0, 16.0), "pulse_s": Uniform(0.4, 3.0), "pulse_rise": Uniform(0.1, 0.5)},
            bounds=AXIS_BOUNDS,
            law=OwnLaw(formulas.trapezium),
        ),
        in_table(
            "{axis}.flexible_mode",
            MODE,
            i,
            drawn={"mass_share": Uniform(0.2, 0.7), "mass_zeta": Uniform(0.03, 0.1)},
            fixed={"mass_reads": 1.0},
            bounds=(0.2, 8.0),
            equivalent=_mode,
        ),
    )


def _sensor_rows(i: int) -> tuple[Effect, ...]:
    """An offset of the azimuth is left out: nothing depends on where azimuth's zero is."""
    offset = in_table(
        "{angle}_sensor.offset",
        Size("offset_rad", 0.03),
        i,
        signed=True,
        drawn={"offset_swing": Uniform(-0.15, 0.15)},
        bounds=(0.02, 8.0),
        law=OwnLaw(formulas.off_centre),
    )
    return (
        *((offset,) if i == 0 else ()),
        in_table(
            "{angle}_sensor.scale",
            Size("scale_error", 0.04),
            i,
            signed=True,
            drawn={"scale_bend": Uniform(0.0, 0.2)},
            bounds=(0.02, 5.0),
            law=OwnLaw(formulas.bent_scale(i)),
        ),
        in_table(
            "{angle}_sensor.delay",
            Size("sensor_delay_s", 0.012),
            i,
            drawn={"sensor_spread": Uniform(0.0, 0.2)},
            bounds=(0.1, 7.0),
        ),
        in_table(
            "{angle}_sensor.lag",
            Size("sensor_lag_s", 0.015),
            i,
            drawn={"sensor_split": Uniform(0.6, 0.9)},
            bounds=(0.05, 8.0),
        ),
        in_table(
            "{angle}_sensor.quantization",
            Size("count_rad", 0.01),
            i,
            drawn={"count_hold": Uniform(0.0, 0.15)},
            bounds=(0.4, 4.0),
        ),
        in_table(
            "{angle}_sensor.backlash",
            Size("backlash_rad", 0.01),
            i,
            drawn={"backlash_split": Uniform(0.1, 0.4)},
            bounds=(0.3, 4.0),
        ),
    )


AIR = (
    in_table(
        "main_rotor.ground_effect",
        Size("ground", 0.06),
        drawn={"ground_reach": Uniform(0.8, 2.0)},
        bounds=(0.01, 12.0),
        law=OwnLaw(formulas.cheeseman, lambda a, shape, target: [a, 0.5 / shape["ground_reach"]]),
    ),
    in_table(
        "tail_rotor.reverse_asymmetry",
        Size("reverse", -0.2),
        signed=True,
        drawn={"reverse_rad_s": Uniform(10.0, 40.0)},
        bounds=(0.05, 4.5),
        law=OwnLaw(formulas.established),
    ),
    in_table(
        "tail_rotor.downwash",
        Size("downwash", 0.08),
        drawn={"downwash_power": Uniform(0.8, 1.6)},
        bounds=WIDE,
        law=OwnLaw(formulas.washed_away),
    ),
)
ONE_AXIS = (
    in_table(
        "elevation.centre_of_gravity",
        Size("centre_rad", 0.06),
        signed=True,
        drawn={"centre_droop": Uniform(0.0, 0.3)},
        bounds=WIDE,
        law=OwnLaw(formulas.droop),
    ),
    in_table(
        "elevation.weight_shift",
        Size("weight", 0.025),
        signed=True,
        drawn={"weight_time_s": Uniform(5.0, 16.0), "weight_ramp_s": Uniform(0.2, 1.0)},
        bounds=WIDE,
    ),
    in_table(
        "elevation.tail_coupling",
        Size("tail_lift", 2e-4),
        signed=True,
        drawn={"tail_lift_power": Uniform(1.7, 2.3)},
        bounds=WIDE,
        law=OwnLaw(formulas.tail_lift),
    ),
    in_table(
        "azimuth.tilt",
        Size("tilt_Nm", 3e-3),
        drawn={"tilt_rad": Uniform(-np.pi, np.pi)},
        bounds=WIDE,
        law=OwnLaw(formulas.reach),
    ),
    in_table(
        "azimuth.gyroscopic",
        Size("gyro_azimuth", 3e-5),
        drawn={"gyro_cant_rad": Uniform(-0.05, 0.05)},
        bounds=(0.01, 10.0),
        law=OwnLaw(formulas.canted),
    ),
    # Only one direction gets harder; the sign says which.
    in_table("azimuth.friction_asymmetry", Size("asymmetry_Nm", 4e-4), 1, signed=True, bounds=(0.03, 12.0)),
)
LOOP = (
    in_table("loop.delay", Size("delay_s", 0.012), 0, 1, drawn=LATE, bounds=(0.1, 8.0)),
    in_table(
        "loop.dropped_frames",
        Size("", 0.1, most=0.6),
        drawn={"burst_frames": OneOf(Fixed(1.0), Uniform(2.0, 6.0))},
        bounds=(0.05, 6.0),
        loses_frames=True,
    ),
)
KNOWN = (*for_both(_input_rows, _rotor_rows, _bearing_rows, _axis_rows, _sensor_rows), *AIR, *ONE_AXIS)
