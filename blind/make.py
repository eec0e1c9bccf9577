"""The generator: a folder of cases whose truth is sealed."""

import hashlib
import os
import shutil
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

from blind.case import Plan, build_case
from blind.files import case_files, draw_defects
from blind.mix import KINDS, plans
from blind.rig import Rig, load_rig
from blind.sealed import CASES_FILE, TRUTH_FILE, Truth, seal
from blind.truth import library
from records.errors import BadInput
from records.files import write_atomic

PLANT = Path(__file__).resolve().parent.parent / "plants" / "ce150.toml"


def make(seed: int, out: Path, cases: int = 60, kinds: Sequence[str] = KINDS, plant: Path = PLANT) -> Path:
    """Write `cases` cases of the given kinds into the folder `out`, the same bytes for the same seed, and return cases.json.

    Layout: case-XXXX/ (plant.toml, train-1, train-2 and hold-1 as .csv and .toml, README.md), cases.json with a commitment to each
    truth, sealed/truth.json. An earlier benchmark in `out` is replaced, as a whole and only when the new one is complete.
    Raises BadInput for a plant that is no CE150, an unknown kind, a negative seed, an `out` that holds something else.
    """
    if seed < 0:
        raise BadInput("seed", "--seed", str(seed), "a number from 0 up", "choose another seed")
    nominal, text = load_rig(plant)
    dealt = plans(cases, kinds, np.random.default_rng([seed, 0]))
    _check_replaceable(out)
    library()
    work = _work_folder(out)
    try:
        names = [f"case-{index:04d}" for index in range(1, len(dealt) + 1)]
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            jobs = [
                pool.submit(_write_case, work, name, nominal, text, plan, (seed, index))
                for index, (name, plan) in enumerate(zip(names, dealt, strict=True), 1)
            ]
            truths = {name: job.result() for name, job in zip(names, jobs, strict=True)}
        public, opened = seal(truths, {name: _salt(seed, name) for name in names})
        write_atomic(work / TRUTH_FILE, opened)
        write_atomic(work / CASES_FILE, public)
        if out.exists():
            shutil.rmtree(out)
        work.chmod(0o755)
        work.rename(out)
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return out / CASES_FILE


def _write_case(work: Path, name: str, nominal: Rig, text: str, plan: Plan, seed: tuple[int, int]) -> Truth:
    case = build_case(nominal, plan, (*seed, 1))
    rng = np.random.default_rng([*seed, 2])
    defects = draw_defects(rng)
    for file, content in case_files(name, case, text, defects, rng).items():
        write_atomic(work / name / file, content)
    return replace(case.truth, defects=(*case.truth.defects, *defects.names))


def _salt(seed: int, name: str) -> str:
    return hashlib.sha256(f"salt of {name}, seed {seed}".encode()).hexdigest()[:32]


def _check_replaceable(out: Path) -> None:
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
