"""The plant at the measured elevation, linearised and sampled, over any arithmetic: what seed 000 has Matlab do, eqs (16)-(21).

    l_M F_M(omega_M) = tau_gE cos Psi,   l_T F_T(omega_T) = K_A omega_M            the operating point of (8) and (9)           (C.14)
    Lambda = Ts d(P_b(w) w)/dw,   kappa = Ts^3 K l F'(w) / J                        rotor's lag, and what it does to the arm       (C.15)
    alpha = Ts^2 (tau_gE sin Psi) / J_E, 0;   beta = Ts b_v / J_E, Ts b_v / (J_A cos Psi)   stiffness and damping                 (C.16)

Time counts in samples and the rotor in volts, r' = Lambda (u - r), x'' = kappa r / Lambda + alpha x - beta x'. With a zero-order hold
this is B/A in powers of gamma = z - 1, where poles near z = 1 do not cancel:

    s_1 = 1, s_n+1 = alpha s_n-1 - beta s_n;   sigma, rho = sum (s_n, s_n-1) / n!    the arm's exp - 1: [[alpha rho, sigma], [.., E]] (C.17)
    R_1 = 1, R_n+1 = -Lambda R_n;   W_n+1 = R_n + alpha W_n-1 - beta W_n;   phi, W, X = sum (R_n, W_n, W_n-1) / n!                 (C.18)
    A = (gamma + Lambda phi) (gamma^2 - (alpha rho + E) gamma + alpha rho E - alpha sigma^2),   E = alpha rho - beta sigma            (C.19)
    B / kappa = X gamma^2 + (phi rho - E X + sigma W) gamma + phi (sigma^2 - E rho)                                               (C.20)

Every sum has terms of one size or falling ones, and B's coefficients come out positive, about 1/6, 1, 1: nothing is lost in float32.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

TERMS = 7  # Lambda <= 0.15: the first one left out is below 1e-10 of the sum
NEWTON_STEPS = 3  # from the largest speed in the range, where the thrust is convex: 1e-9 from 15 % off
COSINE = tuple(1.0 / (n * (n + 1)) for n in (1, 3, 5, 7, 9))
SINE = tuple(1.0 / (n * (n + 1)) for n in (2, 4, 6, 8))


def inverse_factorials() -> tuple[float, ...]:
    """1/2!, 1/3!, .. of (C.17) and (C.18)."""
    values, product = [], 1.0
    for n in range(2, TERMS + 1):
        product /= n
        values.append(product)
    return tuple(values)


@dataclass(frozen=True)
class SampledAxis:
    """A (gamma^2, gamma, 1) beside gamma^3, B/kappa (gamma^2, gamma, 1), and kappa."""

    a_2: Any
    a_1: Any
    a_0: Any
    b_2: Any
    b_1: Any
    b_0: Any
    kappa: Any


def cosine(psi_rad: Any, fractions: Sequence[Any], one: Any) -> Any:
    """cos within the stops, |Psi| < 1: Taylor's series from its last factor."""
    square = psi_rad * psi_rad
    return _nested(square, fractions, one)


def sine(psi_rad: Any, fractions: Sequence[Any], one: Any) -> Any:
    """sin within the stops."""
    return psi_rad * _nested(psi_rad * psi_rad, fractions, one)


def _nested(square: Any, fractions: Sequence[Any], one: Any) -> Any:
    """1 - x f_1 (1 - x f_2 (1 - ..))."""
    value = one
    for fraction in reversed(fractions):
        value = one - square * fraction * value
    return value


def speed_rad_s(model: Any, constants: Any, load: Any) -> Any:
    """(C.14): the speed whose torque is `load`, by Newton's rule from the largest speed in the range."""
    omega = model.start_rad_s
    for _ in range(constants.newton_steps):
        excess = cubic(model.thrust, omega) * omega - load
        omega = omega - excess / cubic(model.slope, omega)
    return omega


def cubic(c: Sequence[Any], x: Any) -> Any:
    """c_0 + c_1 x + c_2 x^2 + c_3 x^3 by Horner."""
    return ((c[3] * x + c[2]) * x + c[1]) * x + c[0]


def sampled_axis(model: Any, constants: Any, omega_rad_s: Any, alpha: Any, beta: Any) -> SampledAxis:
    """(C.15) and (C.17) to (C.20) of one axis at its operating point."""
    lag = (model.lag[2] * omega_rad_s + model.lag[1]) * omega_rad_s + model.lag[0]
    kappa = model.push * cubic(model.slope, omega_rad_s)
    phi, sigma, rho, W, X = _series(constants, lag, alpha, beta)
    E = alpha * rho - beta * sigma
    trace = alpha * rho + E
    determinant = alpha * rho * E - alpha * sigma * sigma
    pole = lag * phi
    return SampledAxis(
        a_2=pole - trace,
        a_1=determinant - pole * trace,
        a_0=pole * determinant,
        b_2=X,
        b_1=phi * rho - E * X + sigma * W,
        b_0=phi * (sigma * sigma - E * rho),
        kappa=kappa,
    )


def _series(constants: Any, lag: Any, alpha: Any, beta: Any) -> tuple[Any, Any, Any, Any, Any]:
    """phi, sigma, rho, W, X of (C.17) and (C.18); the terms of n = 1 are ones and zeros."""
    phi = sigma = s = R = constants.one
    rho = W = X = s_before = W_n = W_before = constants.zero
    for inverse in constants.inverse_factorials:
        s_before, s = s, alpha * s_before - beta * s
        W_before, W_n = W_n, R + alpha * W_before - beta * W_n
        R = -lag * R
        phi = phi + inverse * R
        sigma = sigma + inverse * s
        rho = rho + inverse * s_before
        W = W + inverse * W_n
        X = X + inverse * W_before
    return phi, sigma, rho, W, X
