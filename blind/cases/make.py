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
from blind.rigs.bench import Plan, RigKind
from blind.rigs.table import FIRST, kinds_of_rig
from blind.simulation.ce150 import load_rig
from records.errors import BadInput
from records.files import write_atomic


@dataclass(frozen=True)
class Order:
    """All that one case depends on: which of a benchmark's cases it is, the text of the plant file, the kind of rig.

    `plants`: which of the rig's plants the benchmark's cases are dealt round to.
    """

    seed: int
    index: int
    cases: int
    kinds: tuple[str, ...]
    plant: str
    rig: str
    plants: tuple[int, ...] = (0,)

    @property
    def name(self) -> str:
        """Its folder."""
        return f"case-{self.index:04d}"


Made = dict[str, Any]  # "files": text by name, "truth": as JSON values
Each = Callable[[Callable[[Order], Made], Sequence[Order]], Iterable[Made]]


@dataclass(frozen=True)
class Benchmark:
    """What is asked for: so many `cases` of some kinds with one kind of rig, `plant`: from this file, from those of the rig's own plants if
    None."""

    seed: int
    cases: int = 60
    kinds: Sequence[str] = KINDS
    plant: Path | None = None
    rig: str = FIRST


def make(asked: Benchmark, out: Path, each: Each = map) -> Path:
    """Write the cases of a benchmark into the folder `out`, the same bytes for the same one; returns cases.json.

    `each` makes the cases, in their order, as `map` does.

    Layout: case-XXXX/ (plant.toml, train-1 and so on and hold-1 as .csv and .toml, README.md), cases.json with a commitment to each
    truth, sealed/truth.json. An earlier benchmark in `out` is replaced, as a whole and only when the new one is complete.
    Raises BadInput for a plant that the rig is not, an unknown kind or rig, a negative seed, an `out` that holds something else.
    """
    if asked.seed < 0:
        raise BadInput("seed", "--seed", str(asked.seed), "a number from 0 up", "choose another seed")
    orders = _orders(asked)
    # Refuses what cannot be dealt before anything is flown.
    _dealt(orders[0])
    check_replaceable(out)
    work = _work_folder(out)
    try:
        truths = {}
        for order, made in zip(orders, each(make_case, orders), strict=True):
            for file, content in made["files"].items():
                write_atomic(work / order.name / file, content)
            truths[order.name] = truth_from_json(made["truth"])
        public, opened = seal(truths, {name: salt_of(asked.seed, name) for name in truths})
        write_atomic(work / TRUTH_FILE, opened)
        write_atomic(work / CASES_FILE, public)
        if out.exists():
            shutil.rmtree(out)
        work.chmod(0o755)
        work.rename(out)
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return out / CASES_FILE


def _orders(asked: Benchmark) -> list[Order]:
    """One for each case; one at least, so that what cannot be dealt is refused."""
    texts = _plant_texts(kinds_of_rig(asked.rig), asked.plant)
    whole = Order(asked.seed, 1, asked.cases, tuple(asked.kinds), "", asked.rig, tuple(texts))
    orders = [replace(whole, index=index) for index in range(1, max(asked.cases, 1) + 1)]
    return [replace(order, plant=texts[_plant_of(order)]) for order in orders]


def make_case(order: Order) -> Made:
    """One case, without company: its files, and its truth."""
    seed = (order.seed, order.index)
    kind, plan = _dealt(order)
    case = build_case(kind, kind.read(order.plant, order.name), plan, (*seed, 1))
    rng = np.random.default_rng([*seed, 2])
    defects = draw_defects(rng)
    files = case_files(order.name, case, order.plant, defects, rng)
    beside = {path.name: path.read_text(encoding="utf-8") for path in kind.beside}
    truth = replace(case.truth, defects=(*case.truth.defects, *defects.names))
    return {"files": {**files, **beside}, "truth": truth_to_json(truth)}


def _plant_of(order: Order) -> int:
    """Which of the rig's plants a case is of."""
    return order.plants[(order.index - 1) % len(order.plants)]


def _dealt(order: Order) -> tuple[RigKind, Plan]:
    """The kind of rig and the plan of a case: each plant's cases are dealt as if they were alone."""
    turn, count = (order.index - 1) % len(order.plants), len(order.plants)
    kind = kinds_of_rig(order.rig)[order.plants[turn]]
    own = len(range(turn, order.cases, count)) if order.cases > 0 else order.cases
    seed = [order.seed, 0] if count == 1 else [order.seed, 0, turn]
    dealt = plans(own, order.kinds, kind.catalogue, np.random.default_rng(seed))
    return kind, dealt[(order.index - 1) // count]


def _plant_texts(family: Sequence[RigKind], plant: Path | None) -> dict[int, str]:
    """Plant files by number of the rig's plant: all of its own, or the one that is given; raises BadInput where that is none of them."""
    if plant is None:
        return {number: load_rig(kind.plant, kind.read)[1] for number, kind in enumerate(family)}
    for number, kind in enumerate(family):
        try:
            return {number: load_rig(plant, kind.read)[1]}
        except BadInput as error:
            refused = error
    raise refused


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
