"""How well each pair of an input and an output is matched: over which range, with which coherence, and what the model leaves."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from identification.frequency.match.cost import pair_cost
from identification.frequency.match.fit import FrequencyFit

Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class Pair:
    """One input and output: over which range it was matched, at how many points; mean coherence there, cost, and what is left.

    `misfit` is the rms that the model leaves over that of the responses' random errors. `left_*` are between the responses measured
    and those of the identified model, `stated_*` those of the plant file as it was. All but `coherence` are NaN or None, and `points`
    is 0, where the pair was not matched; coherence is the best there is then.
    """

    input: str
    output: str
    from_rad_s: float | None
    to_rad_s: float | None
    points: int
    coherence: float
    J: float
    misfit: float
    left_dB: float
    left_deg: float
    stated_dB: float
    stated_deg: float


def pairs_of(fit: FrequencyFit, T: Complex, T_stated: Complex) -> Iterator[Pair]:
    """All pairs by output; T and T_stated (f, outputs, inputs) are the responses of the identified model and of the plant file."""
    for o in range(len(fit.model.outputs)):
        for i in range(len(fit.model.inputs)):
            yield _pair(fit, T, T_stated, o, i)


def _pair(fit: FrequencyFit, T: Complex, T_stated: Complex, o: int, i: int) -> Pair:
    mine = (fit.points.output == o) & (fit.points.input == i)
    names, k = (fit.model.inputs[i], fit.model.outputs[o]), fit.points.frequency[mine]
    if not k.size:
        best = float(np.max(fit.responses.coherence[:, o, i]))
        return Pair(*names, None, None, 0, best, 0.0, np.nan, np.nan, np.nan, np.nan, np.nan)
    omega = fit.responses.omega_rad_s[k]
    mean = float(np.mean(fit.responses.coherence[k, o, i]))
    return Pair(
        *names,
        float(omega[0]),
        float(omega[-1]),
        int(k.size),
        mean,
        pair_cost(fit.points, fit.r, o, i),
        _misfit(fit, T, o, i),
        *apart(fit.points.T[mine], T[k, o, i]),
        *apart(fit.points.T[mine], T_stated[k, o, i]),
    )


def _misfit(fit: FrequencyFit, T: Complex, o: int, i: int) -> float:
    """What is left of the responses beside their random errors, eq (3) of responses.py, both as rms."""
    mine = (fit.points.output == o) & (fit.points.input == i)
    k = fit.points.frequency[mine]
    left = float(np.mean(np.abs(fit.points.T[mine] / T[k, o, i] - 1.0) ** 2))
    error = float(np.mean(2.0 * fit.responses.error[k, o, i] ** 2))
    return float(np.sqrt(left / max(error, 1e-300)))


def apart(T_c: Complex, T: Complex) -> tuple[float, float]:
    """Rms difference in dB and in degrees."""
    ratio = np.log(T_c / T)
    gain_dB, phase_deg = 20.0 / np.log(10.0) * ratio.real, np.degrees(ratio.imag)
    return float(np.sqrt(np.mean(gain_dB**2))), float(np.sqrt(np.mean(phase_deg**2)))
