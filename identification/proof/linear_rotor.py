"""The rotor as the educational manual has it, linear in speed and thrust, fitted to the same record as the polynomial one.

(L1)  omega' = K u - omega / T,   (L2)  F = k omega

Figs. 7 and 8 of seed 000 show it beside the polynomial model; it is that model with all higher coefficients 0.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from identification.fit.belief import NOTHING
from identification.fit.ranges import Range
from identification.runs.prediction import predicted
from identification.runs.run import Run, coefficient_names
from identification.stages.estimate import Estimate, estimate

Array = NDArray[np.float64]
KEPT = ("p_b_0", "K", "p_F_1")


@dataclass(frozen=True)
class AgainstLinear:
    """One channel of a rotor's record: the fit of both models, and by how much the linear one's error is larger, rms over rms."""

    channel: str
    fit_percent: float
    linear_fit_percent: float
    rms_ratio: float


def against_linear(polynomial: Estimate, linear: Estimate) -> tuple[AgainstLinear, ...]:
    """Both models of one record, channel by channel."""
    return tuple(
        AgainstLinear(own.channel, 100.0 * own.fit, 100.0 * straight.fit, straight.rms / own.rms)
        for own, straight in zip(polynomial.residuals, linear.residuals, strict=True)
    )


def linear_rotor(run: Run) -> Estimate:
    """Fit (L1), (L2) to the run of experiment 1 or 2, from the slope of its own polynomials at rest."""
    names = coefficient_names(run.bound.model)
    places = [names.index(name) for name in KEPT]
    p = np.zeros(run.bound.p.size)
    p[places] = run.bound.p[places]
    ranges = {
        name: Range(float(p[place]), float(p[place]) / 20.0, float(p[place]) * 50.0, float(p[place]))
        for name, place in zip(KEPT, places, strict=True)
    }
    return estimate([replace(run, bound=replace(run.bound, p=p), alias={})], KEPT, ranges, NOTHING)


def readings_by(result: Estimate) -> Array:
    """What the fitted model of a stage with one run predicts for its readings (m,)."""
    return predicted(result.runs[0], result.belief.names, result.belief.mean)
