"""A case as the files that a rig's owner would hand over: plant, logs with sidecars, a note how to run."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from blind.cases.case import Case
from blind.rigs.bench import Logging
from blind.simulation.ce150 import restated
from blind.simulation.record import Record

Array = NDArray[np.float64]
NUMBER_WORDS = {2: "two", 3: "three", 4: "four"}

SIDECAR = """schema = "run-log/1"
plant = "ce150"
sample_period_s = {period_s}
loop = "closed"
locked = []
"""

README = """{name}: {count} runs of {length_s:g} s of one CE150, plant.toml what is known of it.

    twinlaw diagnose --plant plant.toml --holdout hold-1.csv --out RESULTS/{name} {training}

The hold-out run was flown with another manoeuvre. RESULTS/{name}/diagnosis.json is what `twinlaw blind score` reads; the predictions
beside it are checked against hold-1.csv; {{"time_s": seconds}} in RESULTS/{name}/run.json is counted if it is there.
"""


@dataclass(frozen=True)
class Defects:
    """What is wrong with a case's logs as logs."""

    missing_rows: bool
    not_a_number: bool
    sequence: bool

    @property
    def names(self) -> tuple[str, ...]:
        """In words, for the truth."""
        flags = {"missing rows": self.missing_rows, "not a number": self.not_a_number}
        return tuple(name for name, flag in flags.items() if flag)


def draw_defects(rng: Generator) -> Defects:
    """Few logs have any; a log that misses rows has sequence numbers."""
    missing, nan, numbered = rng.random(3) < (0.06, 0.06, 0.4)
    return Defects(bool(missing), bool(nan), bool(missing or numbered))


def case_files(name: str, case: Case, plant_text: str, defects: Defects, rng: Generator) -> Mapping[str, str]:
    """Content of the case's files by name; the last of its runs is the hold-out."""
    runs = [*(f"train-{number + 1}" for number in range(len(case.records) - 1)), "hold-1"]
    training = " ".join(f"{run}.csv" for run in runs[:-1])
    length_s = case.logging.length_s
    files = {
        "README.md": README.format(name=name, count=NUMBER_WORDS[len(runs)], length_s=length_s, training=training),
        "plant.toml": restated(plant_text, case.restated),
    }
    for run, record in zip(runs, case.records, strict=True):
        files[f"{run}.csv"] = _csv(record, case.truth.rotor_speeds, case.logging, defects, rng)
        files[f"{run}.toml"] = SIDECAR.format(period_s=case.logging.period_s)
    return files


def _csv(record: Record, speeds: bool, logging: Logging, defects: Defects, rng: Generator) -> str:
    n = len(record.t_s)
    y = record.y_rad.copy()
    if defects.not_a_number:
        y[rng.integers(1, n, 12), rng.integers(0, 2, 12)] = np.nan
    columns: dict[str, Array] = {"t_s": np.round(record.t_s - record.t_s[0] + logging.start_s, 6)}
    columns |= {"u_M_V": record.u_V[:, 0], "u_T_V": record.u_V[:, 1], "psi_rad": y[:, 0], "phi_rad": y[:, 1]}
    if speeds:
        noisy = _logged_speeds(record.apparent[:, 4:], logging, rng)
        columns |= {"omega_M_rad_s": noisy[:, 0], "omega_T_rad_s": noisy[:, 1]}
    reference = np.round(record.reference, 7)
    columns |= {"psi_ref_rad": reference[:, 0], "phi_ref_rad": reference[:, 1]}
    kept = np.ones(n, bool)
    if defects.missing_rows:
        kept[rng.integers(1, n, 10)] = False
    cells = [map(repr, column[kept].tolist()) for column in columns.values()]
    if defects.sequence:
        cells.insert(0, map(str, np.flatnonzero(kept).tolist()))
    header = ",".join([*(["seq"] if defects.sequence else []), *columns])
    return "\n".join([header, *map(",".join, zip(*cells, strict=True))]) + "\n"


def _logged_speeds(omega: Array, logging: Logging, rng: Generator) -> Array:
    noisy = omega + logging.speed_noise_rad_s * rng.standard_normal(omega.shape)
    return np.round(logging.speed_step_rad_s * np.round(noisy / logging.speed_step_rad_s), 6)
