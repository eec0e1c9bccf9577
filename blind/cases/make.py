"""The generator: a folder of cases whose truth is sealed."""

import hashlib
import shutil
import tempfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from blind.cases.case import build_case
from blind.cases.files import case_files, draw_defects
from blind.cases.mix import KINDS, plans
from blind.cases.sealed import CASES_FILE, TRUTH_FILE, seal, truth_from_json, truth_to_json
from blind.rigs.table import FIRST, kind_of_rig
from blind.simulation.ce150 import load_rig, read_rig
from records.errors import BadInput
from records.files import write_atomic

PLANT = Path(__file__).resolve().parents[2] / "plants" / "ce150.toml"


@dataclass(frozen=True)
class Order:
    """All that one case depends on: which of a benchmark's cases it is, the text of the plant file, the kind of rig."""

    seed: int
    index: int
    cases: int
    kinds: tuple[str, ...]
    plant: str
    rig: str

    @property
    def name(self) -> str:
        """Its folder."""
        return f"case-{self.index:04d}"


Made = dict[str, Any]  # "files": text by name, "truth": as JSON values
Each = Callable[[Callable[[Order], Made], Sequence[Order]], Iterable[Made]]


def make(
    seed: int,
    out: Path,
    cases: int = 60,
    kinds: Sequence[str] = KINDS,
    plant: Path = PLANT,
    each: Each = map,
    rig: str = FIRST,
) -> Path:
    """Write `cases` cases of some kinds with one kind of rig into the folder `out`, the same bytes for the same seed; returns cases.json.

    `each` makes the cases, in their order, as `map` does.

    Layout: case-XXXX/ (plant.toml, train-1 and so on and hold-1 as .csv and .toml, README.md), cases.json with a commitment to each
    truth, sealed/truth.json. An earlier benchmark in `out` is replaced, as a whole and only when the new one is complete.
    Raises BadInput for a plant that is no CE150, an unknown kind or rig, a negative seed, an `out` that holds something else.
    """
    if seed < 0:
        raise BadInput("seed", "--seed", str(seed), "a number from 0 up", "choose another seed")
    _, text = load_rig(plant)
    # Refuses what cannot be dealt before anything is flown.
    plans(cases, kinds, kind_of_rig(rig).catalogue, np.random.default_rng([seed, 0]))
    check_replaceable(out)
    orders = [Order(seed, index, cases, tuple(kinds), text, rig) for index in range(1, cases + 1)]
    work = _work_folder(out)
    try:
        truths = {}
        for order, made in zip(orders, each(make_case, orders), strict=True):
            for file, content in made["files"].items():
                write_atomic(work / order.name / file, content)
            truths[order.name] = truth_from_json(made["truth"])
        public, opened = seal(truths, {name: salt_of(seed, name) for name in truths})
        write_atomic(work / TRUTH_FILE, opened)
        write_atomic(work / CASES_FILE, public)
        if out.exists():
            shutil.rmtree(out)
        work.chmod(0o755)
        work.rename(out)
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return out / CASES_FILE


def make_case(order: Order) -> Made:
    """One case, without company: its files, and its truth."""
    seed = (order.seed, order.index)
    kind = kind_of_rig(order.rig)
    plan = plans(order.cases, order.kinds, kind.catalogue, np.random.default_rng([order.seed, 0]))[order.index - 1]
    case = build_case(kind, read_rig(order.plant, order.name), plan, (*seed, 1))
    rng = np.random.default_rng([*seed, 2])
    defects = draw_defects(rng)
    files = case_files(order.name, case, order.plant, defects, rng)
    truth = replace(case.truth, defects=(*case.truth.defects, *defects.names))
    return {"files": dict(files), "truth": truth_to_json(truth)}


def salt_of(seed: int, name: str) -> str:
    """What is hashed with the truth of a case."""
    return hashlib.sha256(f"salt of {name}, seed {seed}".encode()).hexdigest()[:32]


def check_replaceable(out: Path) -> None:
    """A folder that holds anything but an earlier benchmark is not ours to replace."""
    if not out.exists() or (out.is_dir() and (not any(out.iterdir()) or (out / CASES_FILE).exists())):
        return
    raise BadInput("output folder", str(out), "other files", "a new or empty folder", "choose another --out")


def _work_folder(out: Path) -> Path:
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        return Path(tempfile.mkdtemp(dir=out.parent, prefix=f".{out.name}."))
    except OSError as error:
        raise BadInput(
            "output folder", str(out), error.strerror or "", "a folder that can be written", "choose another --out"
        ) from error
