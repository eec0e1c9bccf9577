"""The shape of what no effect of the library explains: the free curve that does, drawn against what it depends on."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.detect.curves import ALONE
from diagnosis.detect.signals import Quantity
from diagnosis.library.effect_library import EffectLibrary
from diagnosis.search.free_curve import FittedCurve
from records.text.units import stem, unit_suffix

Array = NDArray[np.float64]
INSTANTS = 201
RARE_PERCENT = 1.0  # percent of the time that a signal spends beyond the curve's ends


@dataclass(frozen=True, eq=False)
class Shape:
    """What is missing, `value` (k,) with `sd` (k,), against `x` (k,) of the quantity `depends`, both about their mean over x.

    It adds to `target`, the rate of a state or an output, times the quantity `times` where there is one. The level itself is left out:
    the plant's own parameters imitate it.
    """

    depends: Quantity
    x: Array
    value: Array
    sd: Array
    target: Quantity
    times: Quantity | None


def shape_of(found: FittedCurve, scale: float) -> Shape:
    """The curve f with weights b of covariance C, on a grid of x whose basis is B, less its mean: f = B b, cov f = scale B C B', where the
    likelihood counts as its root of order `scale`."""
    curve = found.curve
    low, high = np.percentile(np.concatenate(curve.x), [RARE_PERCENT, 100.0 - RARE_PERCENT])
    x = np.linspace(low, high, INSTANTS)
    about = curve.basis(x) - curve.basis(x).mean(axis=0)
    sd = np.sqrt(scale * np.maximum(np.einsum("ij,jk,ik->i", about, found.covariance, about), 0.0))
    size = curve.times.size
    target = target_of(found.case.library, curve.target)
    times = None if curve.times is ALONE else curve.times
    return Shape(curve.depends, x * curve.depends.size, about @ found.b / size, sd / size, target, times)


def target_of(library: EffectLibrary, target: int) -> Quantity:
    """What a form adds to: the rate of a state ("d phi_dot/dt" in rad/s^2), or an output ("phi" in rad)."""
    states = len(library.states)
    name = library.states[target] if target < states else library.outputs[target - states]
    unit = unit_suffix(name)
    shown = unit.replace("_s", "/s")
    if target >= states:
        return Quantity(stem(name), shown)
    return Quantity(f"d {stem(name)}/dt", f"{shown}^2" if shown.endswith("/s") else f"{shown}/s")
