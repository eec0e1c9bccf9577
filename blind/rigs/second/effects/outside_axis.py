"""Effects on the axes that the contract's table does not hold: wear, magnets, cables, people.

A name of the table is a wrong one for them, but for the twins named here.
"""

import numpy as np
from numpy.random import Generator

from blind.effects.effect import Effect, outside_effect, sign


def _both_axes(axis: int) -> tuple[Effect, ...]:
    """A bundle or a weight that hangs loose and swings; steps and slammed doors."""
    name = ("elevation", "azimuth")[axis]
    return (
        outside_effect(
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
        outside_effect(
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
    outside_effect(
        "azimuth.magnet",
        "azimuth",
        "torque(phi) on azimuth",
        lambda m, s: {("magnet_Nm", -1): 3e-3 * m, **{(key, -1): value for key, value in s.items()}},
        lambda rng: {"magnet_rad": _about(rng, 0.5), "magnet_width_rad": rng.uniform(0.08, 0.25)},
        keywords="magnet latch attraction local detent cogging",
    ),
    outside_effect(
        "elevation.creeping_tether",
        "elevation",
        "torque(psi, psi_dot) on elevation",
        lambda m, s: {("maxwell_Nm_rad", -1): 5e-3 * m, ("maxwell_s", -1): s["time_s"]},
        lambda rng: {"time_s": rng.uniform(0.4, 2.5)},
        keywords="viscoelastic maxwell creep relaxation hysteresis",
    ),
    outside_effect(
        "elevation.worn_spot",
        "elevation",
        "torque(psi, sgn psi_dot) on elevation",
        lambda m, s: {("spot_Nm", -1): 1e-3 * m, **{(key, -1): value for key, value in s.items()}},
        lambda rng: {"spot_rad": _about(rng, 0.12), "spot_width_rad": rng.uniform(0.03, 0.12)},
        keywords="worn wear spot patch position local",
    ),
    outside_effect(
        "azimuth.slip_ring",
        "azimuth",
        "torque(phi, sgn phi_dot) on azimuth",
        lambda m, s: {("brush_Nm", -1): 8e-4 * m, ("brush_rad", -1): s["rad"]},
        lambda rng: {"rad": _about(rng, 1.2)},
        keywords="slip_ring brush eccentric position periodic",
    ),
    outside_effect(
        "azimuth.eddy_brake",
        "azimuth",
        "torque(phi_dot) on azimuth",
        lambda m, s: {("eddy_Nms", -1): 5e-3 * m, ("eddy_rad_s", -1): s["rad_s"]},
        lambda rng: {"rad_s": rng.uniform(0.15, 0.5)},
        keywords="eddy brake viscous damping magnetic",
    ),
    outside_effect(
        "elevation.drift",
        "elevation",
        "torque(t) on elevation",
        lambda m, s: {("drift_Nm_s", 0): 1e-4 * m * s["sign"]},
        lambda rng: {"sign": sign(rng)},
        keywords="drift creep ramp thermal leak",
    ),
    outside_effect(
        "elevation.leaning_base",
        "elevation azimuth",
        "torque(psi, phi) on elevation",
        lambda m, s: {("lean_Nm", -1): 4e-3 * m, ("lean_rad", -1): s["rad"]},
        lambda rng: {"rad": _about(rng, np.pi)},
        keywords="tilt lean base level",
    ),
)
