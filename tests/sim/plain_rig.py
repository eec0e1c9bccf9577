"""The CE150 and every effect on it once more in plain numbers, each written out from its formula: what the library is held against.

Rates by hand, RK4 with steps of half a millisecond, inputs as functions of continuous time; no SymPy, no kernel.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from math import cos, exp, floor, pi, sin, sqrt, tan, tanh
from types import SimpleNamespace
from typing import Any

import numpy as np

STEP_S = 5e-4
SAMPLE_S = 0.01
State = list[float]


@dataclass(frozen=True)
class Case:
    """An effect with its values, and the state from which it shows: (omega_M, psi, psi', omega_T, phi, phi')."""

    name: str
    values: dict[str, float]
    start: tuple[float, ...] = (430.0, -0.45, 0.5, 250.0, 0.6, -0.7)


BEGIN_S = 5.0
TAIL_BACKWARDS = (430.0, -0.45, 0.5, -250.0, 0.6, -0.7)
SLOW = (430.0, -0.45, 0.1, 250.0, 0.6, -0.1)
NEAR_STOPS = (430.0, 0.55, 0.2, 250.0, 2.02, 0.3)
NEAR_LOWER_STOP = (430.0, 0.55, 0.2, 250.0, -2.02, -0.3)


def sgn(x: float) -> float:
    return float(x > 0) - float(x < 0)


def squared(x: float) -> float:
    return x * abs(x)


def draught(t: float) -> float:
    """64 sines, each holding its share of the power of a process that forgets in one unit of time, a golden section of a turn apart."""
    slots = [(k, tan(pi * (k + 0.5) / 128)) for k in range(64)]
    return sqrt(2 / 64) * sum(cos(rate * t + 2 * pi * k * (sqrt(5) - 1) / 2) for k, rate in slots)


def ramp(t: float, at: float) -> float:
    return min(max((t - at) / 0.02 + 0.5, 0.0), 1.0)


def bristle(v: float, z: float, z_0: float) -> float:
    return (v - abs(v) * z / z_0) / (1 + (0.008 * abs(v) / z_0) ** 2) ** 0.5


def corner(x: float, width: float) -> float:
    """0 below -width, x above width, a parabola between."""
    return max(x, 0.0) if abs(x) >= width else (x + width) ** 2 / (4 * width)


def dead(u: float, d: float, w: float) -> float:
    return sgn(u) * (corner(abs(u) - d, w * d) - corner(-d, w * d))


def limited(u: float, limit: float, w: float) -> float:
    return u - sgn(u) * corner(abs(u) - limit, w * limit)


def grip(v: float, v_s: float, e: float) -> float:
    """What is left at a speed of the friction above the level: 1 at rest, 1/e at v_s."""
    x = abs(v) / v_s
    return exp(-(x**2) * (1 + e) / (1 + e * x))


def creeps(v: float, v_c: float) -> float:
    """What friction of level 1 lacks where its jump is rounded off: 0.99 (1 - tanh(|v| / v_c)), against its direction."""
    return 0.99 * (sgn(v) - tanh(v / v_c))


# What each effect does, by where it enters: s holds t, the states, the inputs, the rotors' accelerations and the effect's values.
INPUT_M: dict[str, Callable[[Any], float]] = {
    "main_input.deadzone": lambda s: dead(s.u_M, s.d, s.w),
    "main_input.saturation": lambda s: limited(s.u_M, s.limit, s.w),
    "main_input.supply_sag": lambda s: s.u_M * (1 - s.s * (abs(s.u_M) + abs(s.u_T)) / 10),
    "main_input.gain": lambda s: s.gain * s.u_M,
    "loop.gain": lambda s: s.gain * s.u_M,
    "main_input.offset": lambda s: s.u_M + s.offset,
    "main_input.quantization": lambda s: s.q * floor(s.u_M / s.q + 0.5),
}
INPUT_T: dict[str, Callable[[Any], float]] = {
    "tail_input.deadzone": lambda s: dead(s.u_T, s.d, s.w),
    "tail_input.saturation": lambda s: limited(s.u_T, s.limit, s.w),
    "tail_input.supply_sag": lambda s: s.u_T * (1 - s.s * (abs(s.u_M) + abs(s.u_T)) / 10),
    "tail_input.gain": lambda s: s.gain * s.u_T,
    "loop.gain": lambda s: s.gain * s.u_T,
    "tail_input.offset": lambda s: s.u_T + s.offset,
    "tail_input.driver_asymmetry": lambda s: s.u_T * (s.r if s.u_T < 0 else 1.0),
    "tail_input.quantization": lambda s: s.q * floor(s.u_T / s.q + 0.5),
}
DRIVE_M = {"main_rotor.warmup": lambda s: 1 - s.a * (1 - exp(-(s.t - s.t_0) / s.T))}
DRIVE_T = {"tail_rotor.warmup": lambda s: 1 - s.a * (1 - exp(-(s.t - s.t_0) / s.T))}
DRAG_T = {"tail_rotor.reverse_drag": lambda s: s.r if s.w_T < 0 else 1.0}
RUB_M = {"main_rotor.dry_friction": lambda s: s.c * sgn(s.w_M)}
RUB_T = {"tail_rotor.dry_friction": lambda s: s.c * sgn(s.w_T)}
THRUST_M = {"main_rotor.ground_effect": lambda s: 1 + s.a * exp(-(s.psi + pi / 4) / s.psi_0)}
THRUST_T = {
    "tail_rotor.reverse_asymmetry": lambda s: s.r if s.w_T < 0 else 1.0,
    "tail_rotor.downwash": lambda s: 1 - s.a * s.w_M / 600,
}
TORQUE_E: dict[str, Callable[[Any], float]] = {
    "elevation.coulomb": lambda s: -s.b * sgn(s.v_psi),
    "elevation.creep": lambda s: s.b_cE * creeps(s.v_psi, s.v_c),
    "elevation.bristles": lambda s: s.b_cE * (sgn(s.v_psi) - s.z / s.z_0),
    "elevation.stribeck": lambda s: -s.b_s * grip(s.v_psi, s.v_s, s.e) * sgn(s.v_psi),
    "elevation.load_friction": lambda s: -s.c * abs(s.w_M) * sgn(s.v_psi),
    "elevation.friction_asymmetry": lambda s: -s.difference / 2 * (1 + s.e * sgn(s.v_psi)),
    "elevation.quadratic_drag": lambda s: -s.c * abs(s.v_psi) * s.v_psi,
    "elevation.cable_spring": lambda s: -s.k * ((s.psi - s.angle_0) + s.h * (s.psi - s.angle_0) ** 3),
    "elevation.cable_hysteresis": lambda s: -s.k * s.z,
    "elevation.presliding": lambda s: -s.b * s.z / s.z_0,
    "elevation.centre_of_gravity": lambda s: -s.tau_g * (cos(s.psi + s.delta) - cos(s.psi)),
    "elevation.weight_shift": lambda s: -s.Delta * ramp(s.t, s.t_1) * cos(s.psi),
    "elevation.balance_weight": lambda s: -s.tau_g * s.b * cos(s.psi),
    "elevation.offset_force": lambda s: -s.offset,
    "main_rotor.imbalance": lambda s: s.a * s.J_E * s.w_M**2 * sin(s.z),
    "elevation.varying_inertia": lambda s: -s.e * s.a / 2 * s.J_E * cos(s.psi - s.q_0) * s.v_psi**2,
    "elevation.wind": lambda s: s.c * cos(s.phi - s.Phi_w),
    "azimuth.tilt": lambda s: -s.e * s.m * cos(s.phi - s.Phi_0) * sin(s.psi),
    "elevation.upper_stop": lambda s: -s.k * max(s.psi - pi / 4 + s.a, 0.0),
    "elevation.lower_stop": lambda s: s.k * max(-pi / 4 + s.a - s.psi, 0.0),
    "elevation.detent": lambda s: s.amplitude * sin(s.waves * s.psi + s.phase),
    "elevation.periodic_torque": lambda s: s.amplitude * sin(s.rate * s.t + s.phase),
    "elevation.disturbance": lambda s: s.torque * (ramp(s.t, s.t_0) - ramp(s.t, s.t_0 + s.duration)),
    "elevation.gust": lambda s: s.sigma * draught(s.t / s.T),
    "elevation.centrifugal": lambda s: s.c * s.v_phi**2 * sin(2 * s.psi),
    "elevation.tail_gyroscopic": lambda s: s.K * s.w_T * s.v_phi,
    "elevation.tail_coupling": lambda s: s.k * s.w_T * abs(s.w_T),
    "elevation.rotor_acceleration": lambda s: -s.J * s.dw_T,
    "main_rotor.axial_inflow": lambda s: -s.c * abs(s.w_M) * s.v_psi,
}
TORQUE_A: dict[str, Callable[[Any], float]] = {
    "azimuth.coulomb": lambda s: -s.b * sgn(s.v_phi),
    "azimuth.creep": lambda s: s.b_cA * creeps(s.v_phi, s.v_c),
    "azimuth.bristles": lambda s: s.b_cA * (sgn(s.v_phi) - s.z / s.z_0),
    "azimuth.stribeck": lambda s: -s.b_s * grip(s.v_phi, s.v_s, s.e) * sgn(s.v_phi),
    "azimuth.load_friction": lambda s: -s.c * abs(s.w_T) * sgn(s.v_phi),
    "azimuth.friction_asymmetry": lambda s: -s.difference / 2 * (1 + s.e * sgn(s.v_phi)),
    "azimuth.quadratic_drag": lambda s: -s.c * abs(s.v_phi) * s.v_phi,
    "azimuth.cable_spring": lambda s: -s.k * ((s.phi - s.angle_0) + s.h * (s.phi - s.angle_0) ** 3),
    "azimuth.cable_hysteresis": lambda s: -s.k * s.z,
    "azimuth.presliding": lambda s: -s.b * s.z / s.z_0,
    "azimuth.offset_force": lambda s: -s.offset,
    "azimuth.tilt": lambda s: -s.m * sin(s.phi - s.Phi_0) * (1 - s.e + s.e * cos(s.psi)),
    "azimuth.wind": lambda s: s.c * squared(cos(s.phi - s.Phi_w) - s.T_w * s.v_phi),
    "azimuth.upper_stop": lambda s: -s.k * max(s.phi - s.Phi_lim + s.a, 0.0),
    "azimuth.lower_stop": lambda s: s.k * max(-s.Phi_lim + s.a - s.phi, 0.0),
    "azimuth.detent": lambda s: s.amplitude * sin(s.waves * s.phi + s.phase),
    "azimuth.periodic_torque": lambda s: s.amplitude * sin(s.rate * s.t + s.phase),
    "azimuth.disturbance": lambda s: s.torque * (ramp(s.t, s.t_0) - ramp(s.t, s.t_0 + s.duration)),
    "azimuth.gust": lambda s: s.sigma * draught(s.t / s.T),
    "azimuth.gyroscopic": lambda s: -s.K * s.v_psi * s.w_M * sin(s.psi),
    "azimuth.coriolis": lambda s: s.c * sin(2 * s.psi) * s.v_psi * s.v_phi,
    "azimuth.quadratic_reaction": lambda s: -s.k * s.w_M * abs(s.w_M) * cos(s.psi),
    "azimuth.rotor_acceleration": lambda s: -s.J * s.dw_M * cos(s.psi),
    "tail_rotor.imbalance": lambda s: s.a * s.J_A * cos(s.psi) * s.w_T**2 * sin(s.z),
    "tail_rotor.axial_inflow": lambda s: -s.c * abs(s.w_T) * s.v_phi,
}
INERTIA_E = {
    "elevation.balance_weight": lambda s: s.j * s.b * s.J_E,
    "elevation.varying_inertia": lambda s: s.a * s.J_E * sin(s.psi - s.q_0),
}
INERTIA_A = {
    "elevation.balance_weight": lambda s: s.j * s.b * s.J_E * cos(s.psi) ** 2,
    "azimuth.inertia_shape": lambda s: s.J_0 + s.J_1 * cos(s.psi) ** 2,
    "azimuth.inertia_without_cosine": lambda s: s.a * s.J_A * (1 - cos(s.psi)),
}
HYSTERESIS = {
    f"{axis}.{kind}": (lambda s, v=v: bristle(getattr(s, v), s.z, s.z_0))
    for axis, v in (("elevation", "v_psi"), ("azimuth", "v_phi"))
    for kind in ("cable_hysteresis", "presliding", "bristles")
}
MISSED = {
    "psi_sensor.missed_counts": lambda s: -s.a * abs(s.w_M) / 600 * s.v_psi,
    "phi_sensor.missed_counts": lambda s: -s.a * abs(s.w_T) / 800 * s.v_phi,
}
TURNS = {"main_rotor.imbalance": ("w_M", 2), "tail_rotor.imbalance": ("w_T", 5)}
LAGS = {"main_input.lag": "u_M", "tail_input.lag": "u_T"}
MODES = {"elevation.flexible_mode": ("psi", "v_psi"), "azimuth.flexible_mode": ("phi", "v_phi")}
PLACE = {"psi_sensor": 0, "phi_sensor": 1, "elevation": 0, "azimuth": 1}


class PlainRig:
    """One run of 0.4 s with a case, or without: `y` (41, 2) at samples of 10 ms."""

    def __init__(self, p: dict[str, Any], case: Case, *, active: bool) -> None:
        self.p, self.case = p, case
        self.name = case.name if active else ""
        self.u = commands()
        self._arrived = self._way() if self.name.endswith((".delay", ".slew_limit", "_input.backlash")) else None
        self.t, self.s = self._run()

    def y(self) -> np.ndarray:
        """Outputs at the samples, behind what the effect does to them."""
        psi, phi = self.s[:, 1], self.s[:, 4]
        whole = np.column_stack([psi, phi])
        place, _, kind = self.name.partition(".")
        if place in PLACE and kind:
            whole[:, PLACE[place]] = self._measured(whole, place, kind)
        return whole[:: round(SAMPLE_S / STEP_S)]

    def _measured(self, whole: np.ndarray, place: str, kind: str) -> np.ndarray:
        one, other = whole[:, PLACE[place]], whole[:, 1 - PLACE[place]]
        v = SimpleNamespace(**self.case.values)
        if kind == "flexible_mode":
            return np.asarray(one + v.gain * self.s[:, 6])
        if kind == "missed_counts":
            return np.asarray(one + self.s[:, 6])
        if kind == "lag":
            return lagged(one, v.tau, self.s[0, 2 if PLACE[place] == 0 else 5])
        if kind == "backlash":
            return play(one, v.width)
        if kind == "delay":
            early = one[0] + (self.t - v.tau - self.t[0]) * self.s[0, 2 if PLACE[place] == 0 else 5]
            return np.where(self.t - v.tau < self.t[0], early, np.interp(self.t - v.tau, self.t, one))
        maps = {
            "offset": lambda: one + v.offset,
            "scale": lambda: one * v.scale,
            "count_slip": lambda: one + v.jump * np.array([ramp(t, v.t_s) for t in self.t]),
            "cross_alignment": lambda: one + v.eps * other,
            "cyclic": lambda: one + v.amplitude * np.sin(v.waves * one + v.phase),
            "quantization": lambda: v.q * np.floor(one / v.q + 0.5),
        }
        return np.asarray(maps[kind]()) if kind in maps else one

    def _run(self) -> tuple[np.ndarray, np.ndarray]:
        extra = 2 if self.name in MODES else 1
        first = [*self.case.start, *[0.0] * extra]
        if self.name in LAGS:
            first[6] = self.u[0][0 if LAGS[self.name] == "u_M" else 1]
        if self.name in MODES:
            first[7] = self.case.start[2 if MODES[self.name][0] == "psi" else 5]
        if self.name in TURNS:  # in the midst of shaking, about the same mean velocity
            speed, velocity = TURNS[self.name]
            first[velocity] -= self.case.values["a"] * first[0 if speed == "w_M" else 3]
        states, count = [first], round(0.4 / STEP_S)
        for k in range(count):
            states.append(self._step(BEGIN_S + k * STEP_S, states[-1], self._input(k)))
        return BEGIN_S + np.arange(count + 1) * STEP_S, np.array(states)

    def _input(self, k: int) -> tuple[float, float]:
        if self._arrived is not None:
            return self._arrived[k]
        return self.u[int(k * STEP_S / SAMPLE_S + 1e-9)]

    def _way(self) -> list[tuple[float, float]]:
        """Inputs for each fine step behind a delay, a play or a slew limit, which fall on fine steps or are averaged over one."""
        fine = [self.u[int(k * STEP_S / SAMPLE_S + 1e-9)] for k in range(round(0.4 / STEP_S))]
        place, kind = self.name.split(".")
        moved = [place in ("main_input", "loop"), place in ("tail_input", "loop")]
        if kind == "delay":
            late = round(self.case.values["tau"] / STEP_S)
            source = [fine[max(k - late, 0)] for k in range(len(fine))]
        elif kind == "backlash":
            source = list(zip(*(play(column, self.case.values["width"]) for column in np.array(fine).T), strict=True))
        else:
            source = list(zip(*(slewed([row[j] for row in fine], self.case.values["r"]) for j in (0, 1)), strict=True))
        if place.endswith("sensor"):
            return fine
        return [
            tuple(a if m else b for a, b, m in zip(s, f, moved, strict=True)) for s, f in zip(source, fine, strict=True)
        ]

    def _step(self, t: float, x: State, u: tuple[float, float]) -> State:
        h = STEP_S
        k1 = self._rates(t, x, u)
        k2 = self._rates(t + h / 2, [a + h / 2 * b for a, b in zip(x, k1, strict=True)], u)
        k3 = self._rates(t + h / 2, [a + h / 2 * b for a, b in zip(x, k2, strict=True)], u)
        k4 = self._rates(t + h, [a + h * b for a, b in zip(x, k3, strict=True)], u)
        return [a + h / 6 * (b + 2 * c + 2 * d + e) for a, b, c, d, e in zip(x, k1, k2, k3, k4, strict=True)]

    def _rates(self, t: float, x: State, u: tuple[float, float]) -> State:
        p, name = self.p, self.name
        values = self.case.values if name else {}
        s = SimpleNamespace(
            t=t, u_M=u[0], u_T=u[1], tau_g=p["tau_gE"], J_A=p["J_A"], J_E=p["J_E"], Phi_lim=p["Phi_lim"], **values
        )
        s.b_cE, s.b_cA = p["b_cE"], p["b_cA"]
        s.w_M, s.psi, s.v_psi, s.w_T, s.phi, s.v_phi, s.z = x[:7]
        u_M, u_T = INPUT_M.get(name, lambda s: s.u_M)(s), INPUT_T.get(name, lambda s: s.u_T)(s)
        if name in LAGS:
            u_M, u_T = (s.z, u_T) if LAGS[name] == "u_M" else (u_M, s.z)
        one, none = (lambda s: 1.0), (lambda s: 0.0)
        drive_M = p["K_M"] * u_M * DRIVE_M.get(name, one)(s)
        drive_T = p["K_T"] * u_T * DRIVE_T.get(name, one)(s)
        s.dw_M = drive_M - damping(p["p_bM"], s.w_M) - RUB_M.get(name, none)(s)
        s.dw_T = drive_T - damping(p["p_bT"], s.w_T) * DRAG_T.get(name, one)(s) - RUB_T.get(name, none)(s)
        lift = p["l_M"] * odd(p["p_FM"], s.w_M) * THRUST_M.get(name, one)(s)
        push = p["l_T"] * odd(p["p_FT"], s.w_T) * THRUST_T.get(name, one)(s)
        elevation = (
            lift - s.tau_g * s.v_phi**2 * sin(2 * s.psi) / (2 * p["g"]) - s.tau_g * cos(s.psi) - p["b_vE"] * s.v_psi
        )
        elevation += p["K_E"] * s.v_phi * s.w_M * sin(s.psi) - p["b_cE"] * sgn(s.v_psi) + TORQUE_E.get(name, none)(s)
        azimuth = (push - p["K_A"] * s.w_M) * cos(s.psi) - p["b_vA"] * s.v_phi - p["b_cA"] * sgn(s.v_phi)
        azimuth += TORQUE_A.get(name, none)(s)
        tipping = p["J_E"] + INERTIA_E.get(name, none)(s)
        turning = p["J_A"] * cos(s.psi) + INERTIA_A.get(name, none)(s)
        return [s.dw_M, s.v_psi, elevation / tipping, s.dw_T, s.v_phi, azimuth / turning, *self._extra(s, x, u)]

    def _extra(self, s: Any, x: State, u: tuple[float, float]) -> list[float]:
        if self.name in MISSED:
            return [MISSED[self.name](s)]
        if self.name in TURNS:
            return [getattr(s, TURNS[self.name][0])]
        if self.name in HYSTERESIS:
            return [HYSTERESIS[self.name](s)]
        if self.name in LAGS:
            return [((u[0] if LAGS[self.name] == "u_M" else u[1]) - s.z) / s.tau]
        if self.name in MODES:
            way = x[7] - getattr(s, MODES[self.name][1])
            return [way, -(s.omega_n**2) * x[6] - 2 * s.zeta * s.omega_n * way]
        return [0.0]


def commands() -> list[tuple[float, float]]:
    """Inputs for 40 samples: both step about, the tail's through zero."""
    k = np.arange(40)
    return list(zip((5.5 + 1.5 * np.sin(0.9 * k)).tolist(), (1.3 + 2.1 * np.cos(0.7 * k)).tolist(), strict=True))


def odd(coefficients: tuple[float, ...], w: float) -> float:
    return sgn(w) * float(sum(c * abs(w) ** i for i, c in enumerate(coefficients)))


def damping(coefficients: tuple[float, ...], w: float) -> float:
    return w * float(sum(c * abs(w) ** i for i, c in enumerate(coefficients)))


def slewed(wanted: list[float], rate: float) -> list[float]:
    """The mean over each fine step of a ramp that follows."""
    at, result = wanted[0], []
    for goal in wanted:
        way = min(max(goal - at, -rate * STEP_S), rate * STEP_S)
        busy = abs(way) / (rate * STEP_S)
        result.append(at + way * (1 - busy / 2))
        at += way
    return result


def lagged(x: np.ndarray, tau: float, rate: float) -> np.ndarray:
    """A first-order lag of a sampled signal, straight between samples, that was in steady motion before."""
    behind, result, stays = tau * rate, [x[0] - tau * rate], exp(-STEP_S / tau)
    for before, after in pairwise(x):
        behind = behind * stays + (after - before) / STEP_S * tau * (1 - stays)
        result.append(after - behind)
    return np.array(result)


def play(x: np.ndarray, width: float) -> np.ndarray:
    at, result = x[0], []
    for value in x:
        at = min(max(at, value - width / 2), value + width / 2)
        result.append(at)
    return np.array(result)
