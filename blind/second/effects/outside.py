"""Effects that the contract's table does not hold: wear, heat, supply, air, magnets, cables, people. A name of the table is a wrong one,
but for the twins named here."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from blind.effect import Effect, Settings, Shape, sign

Draw = Callable[[Generator], Shape]


def _outside(
    name: str,
    places: str,
    depends: str,
    settings: Callable[[float, Shape], Settings],
    draw: Draw = lambda rng: {},
    bounds: tuple[float, float] = (0.02, 15.0),
    keywords: str = "",
    twins: str = "",
    sensor: bool = False,
) -> Effect:
    return Effect(
        name=name,
        places=tuple(places.split()),
        depends=depends,
        settings=settings,
        draw=draw,
        bounds=bounds,
        known=False,
        sensor=sensor,
        keywords=tuple(keywords.split()),
        twins=tuple(twins.split()),
    )


def _both_axes(axis: int) -> tuple[Effect, ...]:
    """A bundle or a weight that hangs loose and swings; steps and slammed doors."""
    name = ("elevation", "azimuth")[axis]
    return (
        _outside(
            f"{name}.loose_mass",
            name,
            f"mode(torque) of {name}",
            lambda m, s: {
                ("mass_share", axis): min(0.04 * m, 0.6),
                ("mass_rad_s", axis): s["rad_s"],
                ("mass_zeta", axis): s["zeta"],
            },
            lambda rng: {"rad_s": rng.uniform(3.0, 9.0), "zeta": rng.uniform(0.05, 0.2)},
            keywords="slosh pendulum swing loose hanging absorber",
            # With a mass on a spring, whose ring the encoder sees, an expert may speak of a mode.
            twins=f"{name}.flexible_mode",
        ),
        _outside(
            f"{name}.knocks",
            name,
            f"torque(t) on {name}",
            lambda m, s: {("knock_Nm", axis): 6e-3 * m, ("knock_every_s", axis): s["every_s"]},
            lambda rng: {"every_s": rng.uniform(0.8, 4.0)},
            keywords="knock impact impulse footstep shock bump gust draught wind",
            twins=f"{name}.disturbance",
        ),
    )


def _about(rng: Generator, reach_rad: float) -> float:
    return float(rng.uniform(-reach_rad, reach_rad))


AXES = (
    *_both_axes(0),
    *_both_axes(1),
    _outside(
        "azimuth.magnet",
        "azimuth",
        "torque(phi) on azimuth",
        lambda m, s: {("magnet_Nm", -1): 3e-3 * m, **{(key, -1): value for key, value in s.items()}},
        lambda rng: {"magnet_rad": _about(rng, 0.5), "magnet_width_rad": rng.uniform(0.08, 0.25)},
        keywords="magnet latch attraction local detent cogging",
    ),
    _outside(
        "elevation.creeping_tether",
        "elevation",
        "torque(psi, psi_dot) on elevation",
        lambda m, s: {("maxwell_Nm_rad", -1): 5e-3 * m, ("maxwell_s", -1): s["time_s"]},
        lambda rng: {"time_s": rng.uniform(0.4, 2.5)},
        keywords="viscoelastic maxwell creep relaxation hysteresis",
    ),
    _outside(
        "elevation.worn_spot",
        "elevation",
        "torque(psi, sgn psi_dot) on elevation",
        lambda m, s: {("spot_Nm", -1): 1e-3 * m, **{(key, -1): value for key, value in s.items()}},
        lambda rng: {"spot_rad": _about(rng, 0.12), "spot_width_rad": rng.uniform(0.03, 0.12)},
        keywords="worn wear spot patch position local",
    ),
    _outside(
        "azimuth.slip_ring",
        "azimuth",
        "torque(phi, sgn phi_dot) on azimuth",
        lambda m, s: {("brush_Nm", -1): 8e-4 * m, ("brush_rad", -1): s["rad"]},
        lambda rng: {"rad": _about(rng, 1.2)},
        keywords="slip_ring brush eccentric position periodic",
    ),
    _outside(
        "azimuth.eddy_brake",
        "azimuth",
        "torque(phi_dot) on azimuth",
        lambda m, s: {("eddy_Nms", -1): 5e-3 * m, ("eddy_rad_s", -1): s["rad_s"]},
        lambda rng: {"rad_s": rng.uniform(0.15, 0.5)},
        keywords="eddy brake viscous damping magnetic",
    ),
    _outside(
        "elevation.drift",
        "elevation",
        "torque(t) on elevation",
        lambda m, s: {("drift_Nm_s", 0): 1e-4 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        keywords="drift creep ramp thermal leak",
    ),
    _outside(
        "elevation.leaning_base",
        "elevation azimuth",
        "torque(psi, phi) on elevation",
        lambda m, s: {("lean_Nm", -1): 4e-3 * m, ("lean_rad", -1): s["rad"]},
        lambda rng: {"rad": _about(rng, np.pi)},
        keywords="tilt lean base level",
    ),
)
ROTORS = (
    _outside(
        "main_rotor.flutter_band",
        "main_rotor",
        "thrust(omega_M)",
        lambda m, s: {("flutter", -1): 0.05 * m, **{(key, -1): value for key, value in s.items()}},
        lambda rng: {"flutter_rad_s": rng.uniform(320.0, 400.0), "flutter_width_rad_s": rng.uniform(15.0, 40.0)},
        bounds=(0.02, 10.0),
        keywords="flutter resonance vibration stall band",
    ),
    _outside(
        "tail_rotor.chipped_blade",
        "tail_rotor",
        "thrust(t) of tail",
        lambda m, s: {("chip", -1): min(0.06 * m, 0.6), ("chip_time_s", -1): s["time_s"]},
        lambda rng: {"time_s": rng.uniform(5.0, 16.0)},
        keywords="chip damage blade break gain_step",
    ),
    _outside(
        "main_rotor.stale_air",
        "main_rotor",
        "thrust(omega_M)",
        lambda m, s: {("stale", -1): min(0.05 * m, 0.5), ("stale_s", -1): s["time_s"]},
        lambda rng: {"time_s": rng.uniform(0.5, 3.0)},
        keywords="recirculation inflow wake dynamic stale",
    ),
    _outside(
        "tail_rotor.vortex_ring",
        "tail_rotor azimuth",
        "thrust(omega_T, phi_dot)",
        lambda m, s: {("vortex", -1): min(0.1 * m, 0.9), **{(key, -1): value for key, value in s.items()}},
        lambda rng: {"vortex_rad_s": sign(rng) * rng.uniform(0.2, 0.6), "vortex_width_rad_s": rng.uniform(0.1, 0.3)},
        bounds=(0.02, 9.0),
        keywords="vortex inflow wake",
    ),
    _outside(
        "main_rotor.flapping",
        "main_rotor azimuth",
        "torque(omega_M, psi_dot) on azimuth",
        lambda m, s: {("flap", -1): 4e-3 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        keywords="flap",
    ),
    _outside(
        "tail_rotor.seizing",
        "tail_rotor",
        "torque(t, sgn omega_T) on rotor",
        lambda m, s: {("seize", 1): 1.5 * m, ("dry_round_rad_s", 1): 3.0},
        keywords="seiz wear friction_growth",
        twins="tail_rotor.dry_friction",
    ),
    _outside(
        "main_rotor.slipping_hub",
        "main_rotor main_input",
        "limit(u_M, omega_M)",
        lambda m, s: {("clutch_rad_s2", -1): 400.0 / m},
        bounds=(0.05, 10.0),
        keywords="slip clutch hub acceleration_limit current torque_limit",
    ),
)
DRIVES = (
    _outside(
        "main_input.brownout",
        "main_input main_rotor",
        "gain(t) of u_M",
        lambda m, s: {("dip", 0): min(0.08 * m, 0.9), ("dip_every_s", 0): s["every_s"], ("dip_long_s", 0): s["long_s"]},
        lambda rng: {"every_s": rng.uniform(1.5, 5.0), "long_s": rng.uniform(0.15, 0.5)},
        keywords="brownout dip supply periodic intermittent",
    ),
    _outside(
        "tail_input.loose_contact",
        "tail_input tail_rotor",
        "gain(t) of u_T",
        lambda m, s: {
            ("dip", 1): min(0.2 * m, 1.0),
            ("dip_every_s", 1): s["every_s"],
            ("dip_long_s", 1): s["long_s"],
            ("dip_spread", 1): 1.0,
        },
        lambda rng: {"every_s": rng.uniform(0.6, 2.5), "long_s": rng.uniform(0.06, 0.3)},
        keywords="contact dropout intermittent loose dip",
    ),
    _outside(
        "tail_input.cross_feed",
        "tail_input",
        "gain(u_M) of u_T",
        lambda m, s: {("cross", 1): 0.03 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        keywords="cross",
    ),
    _outside(
        "tail_input.bias",
        "tail_input tail_rotor",
        "offset(1) of u_T",
        lambda m, s: {("bias_V", 1): 0.15 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        keywords="bias offset",
    ),
)


def _pickup(axis: int) -> Effect:
    """The motor's current bends what a magnetic encoder shows."""
    sensor, current, angle = (("psi_sensor", "u_M", "psi"), ("phi_sensor", "u_T", "phi"))[axis]
    return _outside(
        f"{sensor}.motor_pickup",
        sensor,
        f"output({current}) of {angle}",
        lambda m, s: {("pickup_rad_V", axis): 3e-3 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        keywords="pickup interference magnetic current emi",
        sensor=True,
    )


ENCODERS = (
    _pickup(0),
    _pickup(1),
    _outside(
        "phi_sensor.missed_lines",
        "phi_sensor",
        "output(phi_dot) of phi",
        lambda m, s: {("missed", 1): min(0.1 * m, 0.9), ("missed_rad_s", 1): s["rad_s"]},
        lambda rng: {"rad_s": rng.uniform(0.1, 0.4)},
        keywords="miss lost slip line",
        sensor=True,
    ),
    _outside(
        "psi_sensor.wandering_zero",
        "psi_sensor",
        "output(t) of psi",
        lambda m, s: {("wander_rad_s", 0): 2e-3 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        bounds=(0.02, 3.0),
        keywords="wander drift thermal creep",
        sensor=True,
    ),
)
OUTSIDE = (*AXES, *ROTORS, *DRIVES, *ENCODERS)
