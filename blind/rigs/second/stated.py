"""What a case's plant file states of the second rig, and a rig drawn from exactly that."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.random import Generator

from blind.simulation.ce150 import Rig

ENCODER_COUNTS = (1024, 2048, 4096, 8192)
FURTHEST_SD = 3.0
LEAST_SHARE = 0.02  # of the stated value: what is positive stays so


def draw_stated(nominal: Rig, denied: Sequence[str], rng: Generator) -> tuple[Rig, Mapping[tuple[str, str], str]]:
    """(the rig as stated, what its plant file says otherwise): spreads half to twice as wide, encoders of 1024 to 8192
    counts."""
    factor = float(2.0 ** rng.uniform(-1.0, 1.0))
    sds = {name: np.array([float(f"{factor * sd:.4g}") for sd in values]) for name, values in nominal.sds.items()}
    counts = [int(rng.choice(ENCODER_COUNTS)) for _ in range(2)]
    steps = (2.0 * np.pi / counts[0], 2.0 * np.pi / counts[1])
    zero = {name: np.zeros(1) for name in denied}
    stated = {
        (f"parameters.{name}", "sd"): repr(values.tolist() if len(values) > 1 else float(values[0]))
        for name, values in sds.items()
        if values.any()
    }
    for sensor, count, step in zip(("psi_rad", "phi_rad"), counts, steps, strict=True):
        stated[f"sensors.{sensor}", "resolution_rad"] = f"{step!r} # 2 pi / {count}: {count} counts a turn"
    known = replace(nominal.with_values(zero), sds={**sds, **zero}, resolution_rad=steps)
    return known, stated


def draw_true(known: Rig, rng: Generator) -> Rig:
    """Each number normal with its stated sd, drawn anew where it lies further out than 3 sd or would lose its sign."""
    drawn = {}
    for name, values in known.values.items():
        new = values.copy()
        for index, (value, sd) in enumerate(zip(values, known.sds[name], strict=True)):
            new[index] = _drawn(float(value), float(sd), rng)
        drawn[name] = new
    return known.with_values(drawn)


def _drawn(value: float, sd: float, rng: Generator) -> float:
    while sd > 0.0:
        deviation = float(rng.standard_normal())
        found = value + sd * deviation
        if abs(deviation) <= FURTHEST_SD and found * np.sign(value) >= LEAST_SHARE * abs(value):
            return found
    return value
