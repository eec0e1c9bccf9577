"""Errors of the colour that real rigs' errors have: the numbers of spectra.toml in, noise out."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]
TABLE = Path(__file__).resolve().parent / "spectra.toml"
SHARED = (
    "aeroshield",
    "aeroshield_again",
    "quanser_aero_pitch",
    "quanser_aero_yaw",
    "emps",
    "pendulum",
)  # by rigs without their own
FADED_ROWS = 400  # of an autoregression, until where it started no longer shows


@dataclass(frozen=True)
class Spectrum:
    """x(k) = sum a_j x(k-j) + e(k) at `period_s`; its RMS was `share` of that of what it was taken from."""

    name: str
    period_s: float
    share: float
    coefficients: tuple[float, ...]

    def drawn(self, rng: Generator, rows: int, step_s: float) -> Array:
        """`rows` numbers of RMS 1, `step_s` apart; between the autoregression's own samples as a straight line."""
        count = int(np.ceil(rows * step_s / self.period_s)) + 2
        white = rng.standard_normal(count + FADED_ROWS)
        own = lfilter([1.0], [1.0, *(-a for a in self.coefficients)], white)[FADED_ROWS:]
        found = np.interp(np.arange(rows) * step_s, np.arange(count) * self.period_s, own)
        return np.asarray(found / np.sqrt(np.mean(found**2)))


@cache
def spectra() -> Mapping[str, tuple[Spectrum, ...]]:
    """Those of readings ("reading") and of what pushes the axes ("push")."""
    content = tomllib.loads(TABLE.read_text(encoding="utf-8"))
    return MappingProxyType(
        {
            kind: tuple(Spectrum(e["name"], e["period_s"], e["share"], tuple(e["coefficients"])) for e in content[kind])
            for kind in ("reading", "push")
        }
    )


def called(kind: str, names: Sequence[str]) -> tuple[Spectrum, ...]:
    """The spectra of a kind with these names, in their order; those that rigs share where none is named."""
    known = {spectrum.name: spectrum for spectrum in spectra()[kind]}
    return tuple(known[name] for name in names or SHARED)
