"""Are these logs what they say they are? Looked at before anything is concluded from them; nothing is repaired silently.

Rows that cannot be used are marked, everything odd is said, and what makes a log worthless is refused by `demand`.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from logcheck.between import duplicate_findings, plant_pair_findings
from logcheck.breaks import break_findings
from logcheck.facts import PlantFacts, plant_facts
from logcheck.finding import REFUSE, Finding, Found, Rows, beginning, bridged, marked, without
from logcheck.inputs import input_findings
from logcheck.plant import plant_findings
from logcheck.stamps import timing, timing_findings
from logcheck.stands.foretold import foretold_findings
from logcheck.values import value_findings
from logcheck.zeros import zero_input_findings
from records.errors import BadInput
from records.log import RunLog
from records.reasons import Note
from sim.bind import BoundPlant
from sim.columns import log_columns


@dataclass(frozen=True, eq=False)
class LogIntegrity:
    """One log: which rows (n,) are left out, which readings (n, outputs) beside these, which commands (n, inputs) are not known, and which
    rows (n,) begin another log."""

    name: str
    excluded: Rows
    unread: Rows
    unknown: Rows
    begins: Rows


@dataclass(frozen=True, eq=False)
class Integrity:
    """All logs, training first and then hold-out, and everything that was found, the worst first."""

    logs: tuple[LogIntegrity, ...]
    findings: tuple[Finding, ...]

    @property
    def refusals(self) -> tuple[Finding, ...]:
        """Findings that forbid any conclusion."""
        return tuple(finding for finding in self.findings if finding.severity == REFUSE)

    @property
    def notes(self) -> tuple[Note, ...]:
        """Every finding as a note, whose sentence names its log."""
        return tuple(map(_note, self.findings))


def _note(finding: Finding) -> Note:
    where = {"column": finding.column, "start_s": finding.start_s, "end_s": finding.end_s, "rows": finding.rows}
    return Note(finding.kind, finding.log, where, f"{finding.log}: {finding.sentence}")


@np.errstate(over="ignore", invalid="ignore")  # numbers beyond all bounds are what is looked for
def examine(
    logs: Sequence[RunLog],
    plant: BoundPlant | PlantFacts,
    *,
    holdout: Sequence[RunLog] = (),
    names: Sequence[str] | None = None,
) -> Integrity:
    """Examine training logs and hold-out logs of one plant; `names` are those of all logs, training first. Of a plant of which nothing but
    its `PlantFacts` is known, no motion is foretold.

    Never raises for what stands in a log: what is wrong is a finding, and `demand` refuses.
    """
    everything = [*logs, *holdout]
    names = [f"log {index + 1}" for index in range(len(everything))] if names is None else list(names)
    bound, facts = (None, plant) if isinstance(plant, PlantFacts) else (plant, plant_facts(plant))
    found: list[list[Found]] = [
        list(_findings(log, name, bound, facts)) for log, name in zip(everything, names, strict=True)
    ]
    if not any(entry.finding.severity == REFUSE for entry in chain(*found)):
        split = len(logs)
        between = duplicate_findings(logs, names[:split], holdout, names[split:])
        for index, entry in chain(between, plant_pair_findings(everything, names)):
            found[index].append(entry)
    order = {severity: rank for rank, severity in enumerate(("refuse", "exclude", "note"))}
    findings = sorted((entry.finding for entry in chain(*found)), key=lambda finding: order[finding.severity])
    examined = zip(everything, names, found, strict=True)
    return Integrity(tuple(_examined(log, name, own, facts) for log, name, own in examined), tuple(findings))


OTHER_NUMBERS = (
    "time_unit",
    "unit_slip",
    "sign_turns",
    "columns",
)  # kinds of findings: such numbers can be neither replayed nor predicted


def demand(integrity: Integrity, kinds: Collection[str] | None = None) -> None:
    """Raise BadInput with the first finding, of some `kinds` or of any, that forbids any conclusion."""
    for finding in integrity.refusals:
        if kinds is not None and finding.kind not in kinds:
            continue
        where = finding.log if finding.column is None else f"{finding.log}, column {finding.column!r}"
        raise BadInput(finding.kind.replace("_", " "), where, finding.sentence, finding.expected, finding.remedy)


def _findings(log: RunLog, name: str, bound: BoundPlant | None, facts: PlantFacts) -> Iterator[Found]:
    """All findings within one log; those that make others meaningless end the list."""
    if bound is not None and not _is_of(log, bound):
        yield _other_plant(log, name, bound)
        return
    own = list(timing_findings(log, name, timing(log)))
    yield from own
    if any(entry.finding.severity == REFUSE for entry in own):
        return
    breaks = list(break_findings(log, name))
    yield from breaks
    zeros = [found for column in log.columns.inputs for found in zero_input_findings(log, name, column)]
    yield from zeros
    log = without(log, zeros)
    own = list(value_findings(log, name, facts.steps, facts.positions, facts.stops, facts.moved_by))
    if any(entry.finding.severity == REFUSE for entry in own):
        yield from own
        return
    begins = beginning((*breaks, *own), len(log.t_s))
    own += [] if bound is None else list(plant_findings(log, name, bound, facts))
    yield from own
    if bound is not None and not any(entry.finding.severity == REFUSE for entry in own):
        yield from foretold_findings(without(log, own), name, bound, facts, begins)
    yield from input_findings(log, name, facts.limits)
    if log.source is not None and log.source.simulated:
        span = (float(log.t_s[0]), float(log.t_s[-1]))
        yield Found(Finding("simulated", name, None, *span, "its source says that these numbers are simulated"))


def _is_of(log: RunLog, bound: BoundPlant) -> bool:
    expected = log_columns(bound.model)
    return (log.columns.inputs, log.columns.outputs) == (expected.inputs, expected.outputs)


def _other_plant(log: RunLog, name: str, bound: BoundPlant) -> Found:
    got = f"columns {', '.join((*log.columns.inputs, *log.columns.outputs))} of plant {log.columns.plant!r}"
    expected = f"those of {bound.model.name!r}"
    span = (float(log.t_s[0]), float(log.t_s[-1])) if len(log.t_s) else (0.0, 0.0)
    return Found(Finding("other_plant", name, None, *span, got, REFUSE, 0, expected, "give the log's own plant"))


def _examined(log: RunLog, name: str, found: Sequence[Found], facts: PlantFacts) -> LogIntegrity:
    rows, own = len(log.t_s), (*log.columns.inputs, *log.columns.outputs)
    excluded = np.zeros(rows, bool)
    for entry in found:
        if entry.excluded is not None and entry.finding.column not in own:
            excluded |= entry.excluded
    return LogIntegrity(
        name=name,
        excluded=excluded,
        unread=marked(log.columns.outputs, found, rows),
        unknown=marked(log.columns.inputs, found, rows),
        begins=beginning(found, rows),
    )


def as_read(log: RunLog, looked: LogIntegrity) -> RunLog:
    """The log with no reading where an output was not read, whatever stands there, and commands that are not known between those beside."""
    if not looked.unread.any() and not looked.unknown.any():
        return log
    return replace(log, y=np.where(looked.unread, np.nan, log.y), u=bridged(log, looked.unknown))


def as_sent(log: RunLog, looked: LogIntegrity) -> RunLog:
    """The log with no number for a command that is not known: what a law answered there cannot be compared."""
    return replace(log, u=np.where(looked.unknown, np.nan, log.u)) if looked.unknown.any() else log
