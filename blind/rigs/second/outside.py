"""The second rig's effects that the contract's table does not hold: wear, magnets, cables, people, damage, air, supply, wiring, heat.

A name of the table is a wrong one for them, but for the twins named here.
"""

import numpy as np

from blind.effects.ce150_table import outside_table
from blind.effects.draws import EitherSign, Uniform
from blind.effects.effect import Effect, Size, over


def _loose_mass(i: int) -> Effect:
    """A bundle or a weight that hangs loose and swings; as the encoder sees it ring, an expert may speak of a mode."""
    return outside_table(
        "{axis}.loose_mass",
        "{axis}",
        "mode(torque) of {axis}",
        Size("mass_share", 0.04, most=0.6),
        i,
        drawn={"mass_rad_s": Uniform(3.0, 9.0), "mass_zeta": Uniform(0.05, 0.2)},
        keywords="slosh pendulum swing loose hanging absorber",
        twins="{axis}.flexible_mode",
    )


def _knocks(i: int) -> Effect:
    """Steps and slammed doors."""
    return outside_table(
        "{axis}.knocks",
        "{axis}",
        "torque(t) on {axis}",
        Size("knock_Nm", 6e-3),
        i,
        drawn={"knock_every_s": Uniform(0.8, 4.0)},
        keywords="knock impact impulse footstep shock bump gust draught wind",
        twins="{axis}.disturbance",
    )


def _pickup(i: int) -> Effect:
    """The motor's current bends what a magnetic encoder shows."""
    return outside_table(
        "{angle}_sensor.motor_pickup",
        "{angle}_sensor",
        "output(u_{letter}) of {angle}",
        Size("pickup_rad_V", 3e-3),
        i,
        signed=True,
        bounds=(0.02, 4.0),
        keywords="pickup interference magnetic current emi",
        sensor=True,
    )


AXES = (
    _loose_mass(0),
    _knocks(0),
    _loose_mass(1),
    _knocks(1),
    outside_table(
        "azimuth.magnet",
        "azimuth",
        "torque(phi) on azimuth",
        Size("magnet_Nm", 3e-3),
        drawn={"magnet_rad": Uniform(-0.5, 0.5), "magnet_width_rad": Uniform(0.08, 0.25)},
        keywords="magnet latch attraction local detent cogging",
    ),
    outside_table(
        "elevation.creeping_tether",
        "elevation",
        "torque(psi, psi_dot) on elevation",
        Size("maxwell_Nm_rad", 5e-3),
        drawn={"maxwell_s": Uniform(0.4, 2.5)},
        keywords="viscoelastic maxwell creep relaxation hysteresis",
    ),
    outside_table(
        "elevation.worn_spot",
        "elevation",
        "torque(psi, sgn psi_dot) on elevation",
        Size("spot_Nm", 1e-3),
        drawn={"spot_rad": Uniform(-0.12, 0.12), "spot_width_rad": Uniform(0.03, 0.12)},
        keywords="worn wear spot patch position local",
    ),
    outside_table(
        "azimuth.slip_ring",
        "azimuth",
        "torque(phi, sgn phi_dot) on azimuth",
        Size("brush_Nm", 8e-4),
        drawn={"brush_rad": Uniform(-1.2, 1.2)},
        keywords="slip_ring brush eccentric position periodic",
    ),
    outside_table(
        "azimuth.eddy_brake",
        "azimuth",
        "torque(phi_dot) on azimuth",
        Size("eddy_Nms", 5e-3),
        drawn={"eddy_rad_s": Uniform(0.15, 0.5)},
        keywords="eddy brake viscous damping magnetic",
    ),
    outside_table(
        "elevation.drift",
        "elevation",
        "torque(t) on elevation",
        Size("drift_Nm_s", 1e-4),
        0,
        signed=True,
        keywords="drift creep ramp thermal leak",
    ),
    outside_table(
        "elevation.leaning_base",
        "elevation azimuth",
        "torque(psi, phi) on elevation",
        Size("lean_Nm", 4e-3),
        drawn={"lean_rad": Uniform(-np.pi, np.pi)},
        keywords="tilt lean base level",
    ),
)
ROTORS = (
    outside_table(
        "main_rotor.flutter_band",
        "main_rotor",
        "thrust(omega_M)",
        Size("flutter", 0.05),
        drawn={"flutter_rad_s": Uniform(320.0, 400.0), "flutter_width_rad_s": Uniform(15.0, 40.0)},
        bounds=(0.02, 10.0),
        keywords="flutter resonance vibration stall band",
    ),
    outside_table(
        "tail_rotor.chipped_blade",
        "tail_rotor",
        "thrust(t) of tail",
        Size("chip", 0.06, most=0.6),
        drawn={"chip_time_s": Uniform(5.0, 16.0)},
        keywords="chip damage blade break gain_step",
    ),
    outside_table(
        "main_rotor.stale_air",
        "main_rotor",
        "thrust(omega_M)",
        Size("stale", 0.05, most=0.5),
        drawn={"stale_s": Uniform(0.5, 3.0)},
        keywords="recirculation inflow wake dynamic stale",
    ),
    outside_table(
        "tail_rotor.vortex_ring",
        "tail_rotor azimuth",
        "thrust(omega_T, phi_dot)",
        Size("vortex", 0.1, most=0.9),
        drawn={"vortex_rad_s": EitherSign(Uniform(0.2, 0.6)), "vortex_width_rad_s": Uniform(0.1, 0.3)},
        bounds=(0.02, 9.0),
        keywords="vortex inflow wake",
    ),
    outside_table(
        "main_rotor.flapping",
        "main_rotor azimuth",
        "torque(omega_M, psi_dot) on azimuth",
        Size("flap", 4e-3),
        signed=True,
        keywords="flap",
    ),
    outside_table(
        "tail_rotor.seizing",
        "tail_rotor",
        "torque(t, sgn omega_T) on rotor",
        Size("seize", 1.5),
        1,
        fixed={"dry_round_rad_s": 3.0},
        keywords="seiz wear friction_growth",
        twins="tail_rotor.dry_friction",
    ),
    outside_table(
        "main_rotor.slipping_hub",
        "main_rotor main_input",
        "limit(u_M, omega_M)",
        Size("clutch_rad_s2", 400.0, over),
        bounds=(0.05, 10.0),
        keywords="slip clutch hub acceleration_limit current torque_limit",
    ),
)
DRIVES = (
    outside_table(
        "main_input.brownout",
        "main_input main_rotor",
        "gain(t) of u_M",
        Size("dip", 0.08, most=0.9),
        0,
        drawn={"dip_every_s": Uniform(1.5, 5.0), "dip_long_s": Uniform(0.15, 0.5)},
        keywords="brownout dip supply periodic intermittent",
    ),
    outside_table(
        "tail_input.loose_contact",
        "tail_input tail_rotor",
        "gain(t) of u_T",
        Size("dip", 0.2, most=1.0),
        1,
        drawn={"dip_every_s": Uniform(0.6, 2.5), "dip_long_s": Uniform(0.06, 0.3)},
        fixed={"dip_spread": 1.0},
        keywords="contact dropout intermittent loose dip",
    ),
    outside_table(
        "tail_input.cross_feed", "tail_input", "gain(u_M) of u_T", Size("cross", 0.03), 1, signed=True, keywords="cross"
    ),
    outside_table(
        "tail_input.bias",
        "tail_input tail_rotor",
        "offset(1) of u_T",
        Size("bias_V", 0.15),
        1,
        signed=True,
        keywords="bias offset",
    ),
)
ENCODERS = (
    _pickup(0),
    _pickup(1),
    outside_table(
        "phi_sensor.missed_lines",
        "phi_sensor",
        "output(phi_dot) of phi",
        Size("missed", 0.1, most=0.9),
        1,
        drawn={"missed_rad_s": Uniform(0.1, 0.4)},
        keywords="miss lost slip line",
        sensor=True,
    ),
    outside_table(
        "psi_sensor.wandering_zero",
        "psi_sensor",
        "output(t) of psi",
        Size("wander_rad_s", 2e-3),
        0,
        signed=True,
        bounds=(0.02, 3.0),
        keywords="wander drift thermal creep",
        sensor=True,
    ),
)
OUTSIDE = (*AXES, *ROTORS, *DRIVES, *ENCODERS)
