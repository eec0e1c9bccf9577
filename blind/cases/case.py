"""One case: a rig, its hidden effects, its runs, and the truth about them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from blind.cases.injection import fly_with_shadows, loss, within_range
from blind.cases.sealed import Truth
from blind.cases.sizing import CONTENT_FROM, as_expected, sized
from blind.cases.truth import truth_of
from blind.rigs.bench import Columns, Logging, Plan, RigKind
from blind.simulation.ce150 import Rig
from blind.simulation.record import Record

ATTEMPTS = 20
LIVELY_FROM = 2  # attempts after which what no quiet run shows is flown excited


@dataclass(frozen=True, eq=False)
class Case:
    """Runs (training, hold-out last), how they are logged, what their columns are called, what the plant file states otherwise, and
    the truth."""

    records: tuple[Record, ...]
    logging: Logging
    columns: Columns
    restated: Mapping[tuple[str, str], str]
    truth: Truth


def build_case(kind: RigKind, nominal: Rig, plan: Plan, seed: Sequence[int]) -> Case:
    """Draw until the rig stays off its stops and each effect has about its wanted severity; the same seed gives the same case.

    Raises RuntimeError where no draw does.
    """
    for attempt in range(ATTEMPTS):
        if attempt == LIVELY_FROM and plan.effects:
            plan = replace(plan, excited=True)
        case = _attempt(kind, nominal, plan, seed, attempt)
        if case is not None:
            return case
    names = " + ".join(effect.name for effect in plan.effects)
    raise RuntimeError(f"no flyable draw of {names or 'a rig without effect'} in {ATTEMPTS} attempts")


def _attempt(kind: RigKind, nominal: Rig, plan: Plan, seed: Sequence[int], attempt: int) -> Case | None:
    rng = np.random.default_rng([*seed, attempt])
    bench = kind.draw_bench(nominal, plan, rng)
    milder = 0.75 ** max(0, attempt - CONTENT_FROM)
    wanted = zip(plan.effects, plan.targets, strict=True)
    found = [sized(bench, effect, milder * target, rng, attempt) for effect, target in wanted]
    injected = [entry for entry in found if entry is not None]
    if len(injected) < len(found):
        return None
    lost = loss(injected)
    inputs = (bench.lab.inputs(rng, lost, run) for run in range(bench.training + 1))
    records = tuple(fly_with_shadows(bench, injected, run) for run in inputs)
    if not all(within_range(record) for record in records) or not as_expected(bench, injected, records[:-1], attempt):
        return None
    return Case(records, bench.logging, bench.columns, bench.restated, truth_of(bench, plan, injected, records))
