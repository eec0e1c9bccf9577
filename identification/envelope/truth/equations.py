"""Equations of the simulated helicopter: rigid body with six degrees of freedom, tilting rotor disc, induced velocity, airframe.

State s (11, n): u v w [m/s], p q r [rad/s], phi theta [rad], beta_1c beta_1s [rad] (disc up at the tail, up at starboard), v_i [m/s].
Controls c (4, n) in per cent. All flights of a batch are columns. The two flapping angles and the induced velocity are more than the
linear models of the thesis hold: whether eight states suffice is what they are to find out.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.envelope.truth.figures import Machine

Array = NDArray[np.float64]
STATE_COUNT = 11
G_m_s2 = 9.80665


@dataclass(frozen=True, eq=False)
class Air:
    """What differs from flight to flight, each (n,): air density and the station of the centre of gravity."""

    density_kg_m3: Array
    station_m: Array


@dataclass(frozen=True, eq=False)
class Loads:
    """Force [N] and moment [N m] on the body about its centre of gravity, each (3, n)."""

    force: Array
    moment: Array


def rates(machine: Machine, air: Air, s: Array, c: Array, gust_m_s: Array) -> Array:
    """ds/dt (11, n); `gust_m_s` (3, n) is the air's own motion, body axes."""
    loads, rotor_rates = _loads(machine, air, s, c, gust_m_s)
    u, v, w, p, q, r, phi, theta = s[:8]
    X, Y, Z = loads.force / machine.mass_heavy_kg
    body = [
        X - G_m_s2 * np.sin(theta) - q * w + r * v,
        Y + G_m_s2 * np.cos(theta) * np.sin(phi) - r * u + p * w,
        Z + G_m_s2 * np.cos(theta) * np.cos(phi) - p * v + q * u,
        *turning(machine, s, loads.moment),
        p + (q * np.sin(phi) + r * np.cos(phi)) * np.tan(theta),
        q * np.cos(phi) - r * np.sin(phi),
    ]
    return np.array([*body, *rotor_rates])


def turning(machine: Machine, s: Array, moment: Array) -> Array:
    """Euler's equations: (dp/dt, dq/dt, dr/dt) of a body with the product of inertia Ixz."""
    p, q, r = s[3:6]
    Ix, Iy, Iz, Ixz = machine.Ixx_kg_m2, machine.Iyy_kg_m2, machine.Izz_kg_m2, machine.Ixz_kg_m2
    L = moment[0] - (Iz - Iy) * q * r + Ixz * p * q
    M = moment[1] - (Ix - Iz) * r * p - Ixz * (p**2 - r**2)
    N = moment[2] - (Iy - Ix) * p * q - Ixz * q * r
    scale = Ix * Iz - Ixz**2
    return np.array([(Iz * L + Ixz * N) / scale, M / Iy, (Ixz * L + Ix * N) / scale])


def specific_force(machine: Machine, air: Air, s: Array, c: Array, gust_m_s: Array) -> Array:
    """What an accelerometer reads (3, n) [m/s^2]: (force / mass) + d(omega)/dt x r + omega x (omega x r), r its arm."""
    loads, _ = _loads(machine, air, s, c, gust_m_s)
    omega = s[3:6]
    arm = np.stack(
        [
            air.station_m - machine.accelerometer_station_m,
            np.zeros_like(air.station_m),
            np.full_like(air.station_m, machine.accelerometer_depth_m),
        ]
    )
    spin = _cross(turning(machine, s, loads.moment), arm) + _cross(omega, _cross(omega, arm))
    return np.asarray(loads.force / machine.mass_heavy_kg + spin)


def _cross(a: Array, b: Array) -> Array:
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _loads(machine: Machine, air: Air, s: Array, c: Array, gust_m_s: Array) -> tuple[Loads, tuple[Array, Array, Array]]:
    """Sum over the parts, and the rates of the rotor's own three states."""
    through_air = np.array([*(s[:3] - gust_m_s), *s[3:6]])
    rotor, torque_Nm, rotor_rates = _main_rotor(machine, air, s, through_air, c)
    parts = (rotor, _tail_rotor(machine, air, through_air, c), _airframe(machine, air, through_air, s[10]))
    force = np.asarray(sum(part.force for part in parts))
    moment = np.asarray(sum(part.moment for part in parts))
    # A rotor that turns counter-clockwise from above, driven by engines, turns the nose to the right.
    moment[2] += torque_Nm
    return Loads(force, moment), rotor_rates


def _main_rotor(
    m: Machine, air: Air, s: Array, motion: Array, c: Array
) -> tuple[Loads, Array, tuple[Array, Array, Array]]:
    """Blade element theory with uniform inflow in forward flight, disc tilt of first order (Padfield, chapter 3)."""
    u, v, w, p, q, r = motion
    beta_1c, beta_1s, v_i = s[8:]
    x_m, h_m, tip_m_s = air.station_m - m.hub_station_m, m.hub_height_m, m.Omega_rad_s * m.R_m
    u_h, v_h, w_h = u - q * h_m, v + r * x_m + p * h_m, w - q * x_m
    w_n = w_h * np.cos(m.shaft_tilt_rad) - u_h * np.sin(m.shaft_tilt_rad)
    mu, mu_z, inflow = u_h / tip_m_s, w_n / tip_m_s, v_i / tip_m_s
    theta_0 = m.collective_0_rad + m.collective_rad_percent * c[0]
    theta_1s, theta_1c = m.longitudinal_rad_percent * (50.0 - c[1]), m.lateral_rad_percent * (50.0 - c[2])
    solidity = m.blades * m.chord_m / (np.pi * m.R_m)
    area, lift = np.pi * m.R_m**2, m.lift_slope * solidity / 2
    C_T = lift * (
        theta_0 * (1 / 3 + mu**2 / 2) + mu * theta_1s / 2 + (mu_z - inflow) / 2 + m.twist_rad * (1 + mu**2) / 4
    )
    dynamic = air.density_kg_m3 * area * tip_m_s**2
    T = dynamic * C_T
    C_Q = (inflow - mu_z) * C_T + solidity * m.drag_blade / 8 * (1 + 4.6 * mu**2)
    H = dynamic * solidity * m.drag_blade / 4 * mu
    X, Y, Z = T * (m.shaft_tilt_rad + beta_1c) - H, -T * beta_1s, -T
    hub = m.blades / 2 * m.K_beta_Nm_rad
    loads = Loads(np.array([X, Y, Z]), np.array([h_m * Y - hub * beta_1s, -h_m * X - hub * beta_1c - x_m * Z, x_m * Y]))
    through_m_s = np.sqrt(u_h**2 + v_h**2 + (v_i - w_n) ** 2)
    v_i_rate = (T / (air.density_kg_m3 * area) - 2 * through_m_s * v_i) * 3 * np.pi / (8 * m.R_m)
    tilt = _tilt(m, (mu, mu_z, inflow), (theta_0, theta_1s, theta_1c), p / m.Omega_rad_s, q / m.Omega_rad_s)
    lag_s = 16.0 / (m.lock * m.Omega_rad_s)
    return loads, dynamic * m.R_m * C_Q, ((tilt[0] - beta_1c) / lag_s, (tilt[1] - beta_1s) / lag_s, v_i_rate)


def _tilt(
    m: Machine, flow: tuple[Array, Array, Array], pitch: tuple[Array, Array, Array], p: Array, q: Array
) -> tuple[Array, Array]:
    """Steady disc tilt from the balance of once-per-turn moments; p and q over the rotor's speed.

    S beta_1c + beta_1s = theta_1c + q + 16 p / gamma - 4/3 mu beta_0 - inflow_1c
    S beta_1s - beta_1c = theta_1s + p - 16 q / gamma + 8/3 mu theta_0 + 2 mu (mu_z - inflow + twist)
    """
    mu, mu_z, inflow = flow
    theta_0, theta_1s, theta_1c = pitch
    inertia_kg_m2 = 1.225 * m.lift_slope * m.chord_m * m.R_m**4 / m.lock
    stiffness = 8.0 / m.lock * m.K_beta_Nm_rad / (inertia_kg_m2 * m.Omega_rad_s**2)
    coning = m.lock / 8 * (theta_0 * (1 + mu**2) + 4 / 3 * (mu_z - inflow) + 0.8 * m.twist_rad)
    wake = np.arctan2(np.abs(mu), inflow - mu_z)
    fore = theta_1c + q + 16 / m.lock * p - 4 / 3 * mu * coning - inflow * np.tan(wake / 2)
    side = theta_1s + p - 16 / m.lock * q + 8 / 3 * mu * theta_0 + 2 * mu * (mu_z - inflow + m.twist_rad)
    scale = 1 + stiffness**2
    return (stiffness * fore - side) / scale, (fore + stiffness * side) / scale


def _tail_rotor(m: Machine, air: Air, motion: Array, c: Array) -> Loads:
    """Thrust to the right, its induced velocity in balance at each instant."""
    u, v, _, p, _, r = motion
    arm_m, tip_m_s = m.tail_arm_m + m.hub_station_m - air.station_m, m.Omega_tail_rad_s * m.R_tail_m
    v_tail = v - arm_m * r + m.tail_height_m * p
    mu, mu_z = u / tip_m_s, -v_tail / tip_m_s
    theta = m.pedals_0_rad - m.pedals_rad_percent * c[3]
    lift = m.lift_slope_tail * m.solidity_tail / 2
    driving = lift * (theta * (1 / 3 + mu**2 / 2) + mu_z / 2)
    # C_T = driving - lift inflow / 2 and C_T = 2 inflow sqrt(mu^2 + (mu_z - inflow)^2): in forward flight mu rules, four rounds do.
    inflow = np.zeros_like(mu)
    for _ in range(4):
        inflow = driving / (lift / 2 + 2 * np.sqrt(mu**2 + (mu_z - inflow) ** 2))
    area = np.pi * m.R_tail_m**2
    T = air.density_kg_m3 * area * tip_m_s**2 * (driving - lift * inflow / 2)
    zero = np.zeros_like(T)
    return Loads(np.array([zero, T, zero]), np.array([m.tail_height_m * T, zero, -arm_m * T]))


def _airframe(m: Machine, air: Air, motion: Array, v_i: Array) -> Loads:
    """Drag and slender-body moments of the fuselage, stabiliser in the rotor's wake, fin."""
    u, v, w, _, q, r = motion
    pressure = air.density_kg_m3 / 2 * np.sqrt(u**2 + v**2 + w**2)  # times a speed: dynamic pressure
    w_tail = w + m.stabiliser_arm_m * q - m.downwash * v_i + m.stabiliser_rad * u
    v_fin = v - m.fin_arm_m * r
    lift = -pressure * m.stabiliser_area_m2 * m.stabiliser_slope * w_tail
    side = -pressure * m.fin_area_m2 * m.fin_slope * v_fin
    X = -pressure * m.drag_area_m2 * u
    Y = -pressure * m.side_area_m2 * v + side
    Z = -pressure * m.plan_area_m2 * (w - v_i) + lift
    M = 2 * pressure * m.pitch_volume_m3 * (w - v_i) + m.stabiliser_arm_m * lift
    N = -2 * pressure * m.yaw_volume_m3 * v - m.fin_arm_m * side
    return Loads(np.array([X, Y, Z]), np.array([0.9 * side, M, N]))
