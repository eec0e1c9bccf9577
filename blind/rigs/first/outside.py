"""The first rig's effects that the contract's table does not hold.

Each has a right place and a functional class; a name of the table is a wrong name.
"""

import numpy as np

from blind.effects.ce150_table import outside_table
from blind.effects.draws import Uniform, Whole
from blind.effects.effect import Effect, Size, over


def _draught(i: int) -> Effect:
    return outside_table(
        "{axis}.draught",
        "{axis}",
        "torque(t) on {axis}",
        Size("draught_Nm", 5e-4),
        i,
        drawn={"draught_rad_s": Uniform(3.0, 12.0), "draught_phase": Uniform(0.0, 6.0)},
        keywords="draught periodic gust wind",
    )


def _inflow(i: int) -> Effect:
    return outside_table(
        "{rotor}_rotor.axial_inflow",
        "{rotor}_rotor {axis}",
        "thrust(omega_{letter}, {angle}_dot)",
        Size("inflow", (1e-5, 3e-5)[i]),
        i,
        keywords="inflow",
    )


def _cyclic(i: int) -> Effect:
    return outside_table(
        "{angle}_sensor.cyclic",
        "{angle}_sensor",
        "output({angle}) of {angle}",
        Size("cyclic_rad", 4e-3),
        i,
        drawn={"cyclic_count": Whole(8, 24), "cyclic_phase": Uniform(0.0, 6.0)},
        keywords="cyclic eccentric periodic",
        sensor=True,
    )


AXES = (
    outside_table(
        "azimuth.wind_drag",
        "azimuth tail_rotor",
        "torque(phi, phi_dot) on azimuth",
        Size("wind", 1.5e-3),
        drawn={"wind_rad": Uniform(-np.pi, np.pi)},
        fixed={"wind_m_s": 1.0},
        keywords="wind draught gust",
    ),
    outside_table(
        "azimuth.cable_hysteresis",
        "azimuth",
        "torque(phi, sgn phi_dot) on azimuth",
        Size("cable_Nm_rad", 5e-3),
        1,
        drawn={"cable_slip_rad": Uniform(0.1, 0.4)},
        keywords="hysteresis bouc dahl presliding lugre",
    ),
    outside_table(
        "azimuth.quadratic_reaction",
        "azimuth main_rotor",
        "torque(omega_M) on azimuth",
        Size("reaction_quadratic", 4e-9),
        signed=True,
        keywords="reaction",
    ),
    outside_table(
        "elevation.load_friction",
        "elevation main_rotor",
        "torque(omega_M, sgn psi_dot) on elevation",
        Size("load_friction_m", 2e-3),
        keywords="load speed_dependent",
    ),
    outside_table(
        "azimuth.inertia_shape",
        "azimuth",
        "inertia(psi) of azimuth",
        Size("inertia_cosine2", 4e-3),
        signed=True,
        bounds=(0.02, 1.5),
        keywords="inertia",
    ),
    outside_table(
        "azimuth.coriolis",
        "azimuth",
        "torque(psi, psi_dot, phi_dot) on azimuth",
        Size("coriolis", 2e-3),
        bounds=(0.05, 3.0),
        keywords="coriolis",
    ),
    outside_table(
        "elevation.bumper",
        "elevation",
        "torque(psi) on elevation",
        Size("bumper_Nm_rad", 0.03),
        drawn={"bumper_rad": Uniform(0.05, 0.2)},
        keywords="bumper stop",
    ),
    outside_table(
        "azimuth.detent",
        "azimuth",
        "torque(phi) on azimuth",
        Size("detent_Nm", 1.5e-3),
        drawn={"detent_count": Whole(5, 12)},
        keywords="detent cogging",
    ),
    outside_table(
        "elevation.grease",
        "elevation",
        "torque(t, psi_dot) on elevation",
        Size("grease", 0.3),
        0,
        drawn={"grease_time_s": Uniform(8.0, 25.0)},
        bounds=(0.05, 3.0),
        keywords="grease viscous thermal",
    ),
    _draught(1),
    _draught(0),
)
DRIVES = (
    _inflow(0),
    _inflow(1),
    outside_table(
        "main_input.current_limit",
        "main_input main_rotor",
        "limit(u_M, omega_M)",
        Size("current_V", 0.4, over),
        0,
        bounds=(0.2, 8.0),
        keywords="current",
    ),
    outside_table(
        "tail_input.memory_band",
        "tail_input",
        "play of u_T",
        Size("play_V", 0.1),
        1,
        bounds=(0.05, 8.0),
        keywords="memory hysteresis play backlash",
    ),
    outside_table(
        "tail_rotor.stall",
        "tail_rotor",
        "thrust(omega_T)",
        Size("stall_rad_s", 450.0, over),
        bounds=(0.3, 1.6),
        keywords="stall",
    ),
)
ENCODERS = (
    outside_table(
        "phi_sensor.cross_talk",
        "phi_sensor azimuth",
        "output(psi) of phi",
        Size("cross", 0.02),
        1,
        signed=True,
        keywords="cross alignment",
        sensor=True,
    ),
    _cyclic(0),
    _cyclic(1),
    outside_table(
        "phi_sensor.count_slip",
        "phi_sensor",
        "output(t) of phi",
        Size("slip_rad", 0.04),
        1,
        signed=True,
        drawn={"slip_time_s": Uniform(6.15, 18.0)},
        keywords="slip index jump",
        sensor=True,
    ),
)
OUTSIDE = (*AXES, *DRIVES, *ENCODERS)
