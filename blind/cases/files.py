"""A case as the files that a rig's owner would hand over: plant, logs with sidecars, a note how to run."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from blind.cases.case import Case
from blind.rigs.bench import Logging, with_word
from blind.simulation.ce150 import restated
from blind.simulation.record import Record

Array = NDArray[np.float64]
NUMBER_WORDS = {2: "two", 3: "three", 4: "four"}

SIDECAR = """schema = "run-log/1"
plant = "{plant}"
sample_period_s = {period_s}
loop = "{loop}"
locked = [{locked}]
"""

README = """{name}: {count} runs of {length} s of one {rig}, plant.toml what is known of it.

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
    rig, length = case.columns.rig, _length(case)
    files = {
        "README.md": README.format(name=name, count=NUMBER_WORDS[len(runs)], length=length, rig=rig, training=training),
        "plant.toml": restated(plant_text, case.restated),
    }
    for run, record in zip(runs, case.records, strict=True):
        files[f"{run}.csv"] = _csv(record, case, defects, rng)
        locked = ", ".join(f'"{axis}"' for axis in record.locked)
        files[f"{run}.toml"] = SIDECAR.format(
            plant=case.columns.plant, period_s=record.period_s, loop=record.loop, locked=locked
        )
    return files


def _length(case: Case) -> str:
    """What the note says of the runs' lengths, s."""
    lengths = [round(len(record.t_s) * record.period_s) for record in case.records]
    return f"{case.logging.length_s:g}" if len(set(lengths)) == 1 else f"{min(lengths)} to {max(lengths)}"


def _csv(record: Record, case: Case, defects: Defects, rng: Generator) -> str:
    n, logging, names = len(record.t_s), case.logging, case.columns
    y = record.y_rad.copy()
    if defects.not_a_number:
        y[rng.integers(1, n, 12), rng.integers(0, y.shape[1], 12)] = np.nan
    t_s = (record.t_s - record.t_s[0]) * record.clock
    columns: dict[str, Array] = {"t_s": np.round(t_s + logging.start_s, 6)}
    columns |= dict(zip((*names.inputs, *names.outputs), (*record.u_V.T, *y.T), strict=True))
    if case.truth.rotor_speeds and names.speeds:
        columns |= dict(zip(names.speeds, _logged_speeds(record.apparent[:, 4:], logging, rng).T, strict=True))
    if record.loop == "closed":
        asked = [with_word(output, "ref") for output in names.outputs]
        columns |= dict(zip(asked, np.round(record.reference, 7).T, strict=False))
    kept = np.ones(n, bool) if record.kept is None else record.kept.copy()
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
