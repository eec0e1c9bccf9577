"""Stability margins of one loop from its frequency response L(e^{j omega Ts}) = B Q / (A P), up to the Nyquist frequency."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from design.loop import OpenLoop

Array = NDArray[np.float64]

POINTS = 1500
LOWEST_RAD_S = 1e-2  # where every loop here still follows its reference: nothing is decided below


@dataclass(frozen=True)
class Margins:
    """Margins of a stable loop.

    `sensitivity` is max |1/(1 + L)|. The loop stays stable while its gain is multiplied by more than `gain_down` (0: any) and
    less than `gain_up` (inf: any), its phase lags by less than `phase_rad` more, or it is late by less than `delay_s` more.
    `crossover_rad_s` is the highest frequency with |L| = 1 (0 where there is none).
    """

    sensitivity: float
    gain_up: float
    gain_down: float
    phase_rad: float
    delay_s: float
    crossover_rad_s: float


def frequency_response(loop: OpenLoop, omega_rad_s: Array) -> NDArray[np.complex128]:
    """L at the frequencies, with gamma = exp(j omega Ts) - 1 formed without cancellation."""
    gamma = np.expm1(1j * omega_rad_s * loop.sample_period_s)
    numerator = np.polyval(loop.b[::-1], gamma) * np.polyval(loop.q[::-1], gamma)
    denominator = np.polyval(loop.a[::-1], gamma) * np.polyval(loop.p[::-1], gamma)
    return np.asarray(numerator / denominator)


def margins(loop: OpenLoop) -> Margins:
    """All margins of a loop whose closed loop is stable; crossings are interpolated between 1500 frequencies."""
    omega = np.geomspace(LOWEST_RAD_S, math.pi / loop.sample_period_s, POINTS)
    response = frequency_response(loop, omega)
    phases_rad, crossovers_rad_s = _gain_crossings(omega, response)
    critical_gains = _critical_gains(loop, response)
    return Margins(
        sensitivity=float(np.max(1.0 / np.abs(1.0 + response))),
        gain_up=float(np.min(critical_gains[critical_gains > 1.0], initial=math.inf)),
        gain_down=float(np.max(critical_gains[critical_gains <= 1.0], initial=0.0)),
        phase_rad=float(np.min(np.minimum(phases_rad, 2.0 * math.pi - phases_rad), initial=math.inf)),
        delay_s=float(np.min(phases_rad / crossovers_rad_s, initial=math.inf)),
        crossover_rad_s=float(np.max(crossovers_rad_s, initial=0.0)),
    )


def _gain_crossings(omega: Array, response: NDArray[np.complex128]) -> tuple[Array, Array]:
    """Phase above -180 deg, in [0, 2 pi), and frequency wherever |L| passes 1."""
    size = np.log(np.abs(response))
    at, share = _sign_changes(size)
    unwrapped = np.unwrap(np.angle(response))
    phase = unwrapped[at] + share * (unwrapped[at + 1] - unwrapped[at])
    frequency = omega[at] * (omega[at + 1] / omega[at]) ** share
    return np.mod(phase + math.pi, 2.0 * math.pi), frequency


def _critical_gains(loop: OpenLoop, response: NDArray[np.complex128]) -> Array:
    """The factors k > 0 for which k L passes through -1: at phase crossings, at rest, at the Nyquist frequency."""
    at, share = _sign_changes(response.imag)
    crossings = response.real[at] + share * (response.real[at + 1] - response.real[at])
    ends = [response.real[-1]]
    at_rest = loop.a[0] * loop.p[0]
    # A plant or controller that integrates has no finite gain at rest; rounding leaves about 1e-15 of it.
    if abs(at_rest) > 1e-12 * np.max(np.abs(loop.a)) * np.max(np.abs(loop.p)):
        ends.append(loop.b[0] * loop.q[0] / at_rest)
    real = np.append(crossings, ends)
    return -1.0 / real[real < 0.0]


def _sign_changes(values: Array) -> tuple[NDArray[np.intp], Array]:
    """Indices i where values[i] and values[i + 1] differ in sign, and how far between them the zero lies."""
    at = np.flatnonzero(np.signbit(values[:-1]) != np.signbit(values[1:]))
    return at, values[at] / (values[at] - values[at + 1])
