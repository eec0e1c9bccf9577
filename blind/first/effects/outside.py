"""Effects that the contract's table does not hold. Each has a right place and a functional class; a name of the table is a wrong name."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from blind.effect import Effect, Settings, Shape, sign


def _outside(
    name: str,
    places: str,
    depends: str,
    settings: Callable[[float, Shape], Settings],
    draw: Callable[[Generator], Shape] = lambda rng: {},
    bounds: tuple[float, float] = (0.01, 10.0),
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


AXES = (
    _outside(
        "azimuth.wind_drag",
        "azimuth tail_rotor",
        "torque(phi, phi_dot) on azimuth",
        lambda m, s: {("wind", -1): 1.5e-3 * m, ("wind_m_s", -1): 1.0, ("wind_rad", -1): s["from_rad"]},
        lambda rng: {"from_rad": rng.uniform(-np.pi, np.pi)},
        keywords="wind draught gust",
    ),
    _outside(
        "azimuth.cable_hysteresis",
        "azimuth",
        "torque(phi, sgn phi_dot) on azimuth",
        lambda m, s: {("cable_Nm_rad", 1): 5e-3 * m, ("cable_slip_rad", 1): s["slip_rad"]},
        lambda rng: {"slip_rad": rng.uniform(0.1, 0.4)},
        keywords="hysteresis bouc dahl presliding lugre",
    ),
    _outside(
        "azimuth.quadratic_reaction",
        "azimuth main_rotor",
        "torque(omega_M) on azimuth",
        lambda m, s: {("reaction_quadratic", -1): 4e-9 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        keywords="reaction",
    ),
    _outside(
        "elevation.load_friction",
        "elevation main_rotor",
        "torque(omega_M, sgn psi_dot) on elevation",
        lambda m, s: {("load_friction_m", -1): 2e-3 * m},
        keywords="load speed_dependent",
    ),
    _outside(
        "azimuth.inertia_shape",
        "azimuth",
        "inertia(psi) of azimuth",
        lambda m, s: {("inertia_cosine2", -1): 4e-3 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        bounds=(0.02, 1.5),
        keywords="inertia",
    ),
    _outside(
        "azimuth.coriolis",
        "azimuth",
        "torque(psi, psi_dot, phi_dot) on azimuth",
        lambda m, s: {("coriolis", -1): 2e-3 * m},
        bounds=(0.05, 3.0),
        keywords="coriolis",
    ),
    _outside(
        "elevation.bumper",
        "elevation",
        "torque(psi) on elevation",
        lambda m, s: {("bumper_Nm_rad", -1): 0.03 * m, ("bumper_rad", -1): s["from_rad"]},
        lambda rng: {"from_rad": rng.uniform(0.05, 0.2)},
        keywords="bumper stop",
    ),
    _outside(
        "azimuth.detent",
        "azimuth",
        "torque(phi) on azimuth",
        lambda m, s: {("detent_Nm", -1): 1.5e-3 * m, ("detent_count", -1): s["count"]},
        lambda rng: {"count": float(rng.integers(5, 12))},
        keywords="detent cogging",
    ),
    _outside(
        "elevation.grease",
        "elevation",
        "torque(t, psi_dot) on elevation",
        lambda m, s: {("grease", 0): 0.3 * m, ("grease_time_s", 0): s["time_s"]},
        lambda rng: {"time_s": rng.uniform(8.0, 25.0)},
        bounds=(0.05, 3.0),
        keywords="grease viscous thermal",
    ),
    _outside(
        "azimuth.draught",
        "azimuth",
        "torque(t) on azimuth",
        lambda m, s: {("draught_Nm", 1): 5e-4 * m, ("draught_rad_s", 1): s["rad_s"], ("draught_phase", 1): s["phase"]},
        lambda rng: {"rad_s": rng.uniform(3.0, 12.0), "phase": rng.uniform(0.0, 6.0)},
        keywords="draught periodic gust wind",
    ),
    _outside(
        "elevation.draught",
        "elevation",
        "torque(t) on elevation",
        lambda m, s: {("draught_Nm", 0): 5e-4 * m, ("draught_rad_s", 0): s["rad_s"], ("draught_phase", 0): s["phase"]},
        lambda rng: {"rad_s": rng.uniform(3.0, 12.0), "phase": rng.uniform(0.0, 6.0)},
        keywords="draught periodic gust wind",
    ),
)
DRIVES = (
    _outside(
        "main_rotor.axial_inflow",
        "main_rotor elevation",
        "thrust(omega_M, psi_dot)",
        lambda m, s: {("inflow", 0): 1e-5 * m},
        keywords="inflow",
    ),
    _outside(
        "tail_rotor.axial_inflow",
        "tail_rotor azimuth",
        "thrust(omega_T, phi_dot)",
        lambda m, s: {("inflow", 1): 3e-5 * m},
        keywords="inflow",
    ),
    _outside(
        "main_input.current_limit",
        "main_input main_rotor",
        "limit(u_M, omega_M)",
        lambda m, s: {("current_V", 0): 0.4 / m},
        bounds=(0.2, 8.0),
        keywords="current",
    ),
    _outside(
        "tail_input.memory_band",
        "tail_input",
        "play of u_T",
        lambda m, s: {("play_V", 1): 0.1 * m},
        bounds=(0.05, 8.0),
        keywords="memory hysteresis play backlash",
    ),
    _outside(
        "tail_rotor.stall",
        "tail_rotor",
        "thrust(omega_T)",
        lambda m, s: {("stall_rad_s", -1): 450.0 / m},
        bounds=(0.3, 1.6),
        keywords="stall",
    ),
)
ENCODERS = (
    _outside(
        "phi_sensor.cross_talk",
        "phi_sensor azimuth",
        "output(psi) of phi",
        lambda m, s: {("cross", 1): 0.02 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        keywords="cross alignment",
        sensor=True,
    ),
    _outside(
        "psi_sensor.cyclic",
        "psi_sensor",
        "output(psi) of psi",
        lambda m, s: {("cyclic_rad", 0): 4e-3 * m, ("cyclic_count", 0): s["count"], ("cyclic_phase", 0): s["phase"]},
        lambda rng: {"count": float(rng.integers(8, 24)), "phase": rng.uniform(0.0, 6.0)},
        keywords="cyclic eccentric periodic",
        sensor=True,
    ),
    _outside(
        "phi_sensor.cyclic",
        "phi_sensor",
        "output(phi) of phi",
        lambda m, s: {("cyclic_rad", 1): 4e-3 * m, ("cyclic_count", 1): s["count"], ("cyclic_phase", 1): s["phase"]},
        lambda rng: {"count": float(rng.integers(8, 24)), "phase": rng.uniform(0.0, 6.0)},
        keywords="cyclic eccentric periodic",
        sensor=True,
    ),
    _outside(
        "phi_sensor.count_slip",
        "phi_sensor",
        "output(t) of phi",
        lambda m, s: {("slip_rad", 1): 0.04 * m * s["sign"], ("slip_time_s", 1): s["time_s"]},
        lambda rng: {"sign": sign(rng), "time_s": rng.uniform(6.15, 18.0)},
        keywords="slip index jump",
        sensor=True,
    ),
)
OUTSIDE = (*AXES, *DRIVES, *ENCODERS)
