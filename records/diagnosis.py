"""What a diagnosis found, as diagnosis.json states it (schema diagnosis/1 of CONTRACT.md)."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from enum import StrEnum
from pathlib import Path
from typing import Any

from records.errors import BadInput
from records.model_comparison import ModelComparison
from records.quality import Quality, quality_facts
from records.reasons import Decision, Note
from records.text import checks
from records.text.json_record import key_of, plain, read, record_of
from records.text.reading import read_json

SCHEMA = "diagnosis/1"
VERDICTS = ("gap", "no gap", "cannot tell")
# Keys that a file may lack.
FURTHER = ("error_responses", "partly", "comparison", "verdict_reason", "decisions", "note_records")
QUALITY = "quality"  # a key beside the record: the colour that pages show, made from it
SHARE_TOLERANCE = 1e-6  # how far shares may sum from 1


@dataclass(frozen=True)
class PlaceShare:
    """How much of the gap lies at a place of the plant ("azimuth", "main_input", "loop")."""

    place: str
    share: float


@dataclass(frozen=True)
class Span:
    """How much of the gap lies between two times."""

    start_s: float
    end_s: float
    share: float


@dataclass(frozen=True)
class Region:
    """How much of the gap lies where a signal is between two values, in the signal's unit."""

    signal: str
    from_: float
    to: float
    share: float


@dataclass(frozen=True)
class Band:
    """How much of the gap lies between two frequencies, and the coherence of the model's error with what explains it there."""

    from_Hz: float
    to_Hz: float
    share: float
    coherence: float | None = None


@dataclass(frozen=True)
class ErrorResponse:
    """By how much an output answers an input otherwise between two frequencies, G_rig / G_model - 1: its size and one standard deviation
    as shares of the model's answer, and its phase; the deviation is that of white noise alone.

    `coherence` is that of the output's error with what its answers to the inputs explain of it.
    """

    output: str
    input: str
    from_Hz: float
    to_Hz: float
    error: float
    sd: float
    phase_rad: float
    coherence: float


class LiesIn(StrEnum):
    """Where that lies in which a log and the controller's own code run again differ."""

    FIRMWARE = "firmware"
    LOG = "log"  # in what it lacks, or holds twice or rounded: the firmware did as its table says
    COLUMNS = "columns"  # the plant may have been given other inputs than the log holds
    UNSEEN = "unseen"  # in how the code was built, or in what was before the log, or behind rows that it lacks
    UNEXPLAINED = "unexplained"


AND = " + "  # between the names of what holds jointly


def names_of(joint: str) -> tuple[str, ...]:
    """The names that "a.b + c.d" joins."""
    return tuple(joint.split(AND))


@dataclass(frozen=True)
class Firmware:
    """The controller's own code run again on the log; `cause` is a `sentence` behind its `names`, None where nothing differs.

    `lies_in` is one of LiesIn, None where nothing differs or no code was run again.
    """

    replayed: bool
    bit_exact: bool
    first_difference_s: float | None
    cause: str | None
    names: tuple[str, ...] = ()
    lies_in: str | None = None
    sentence: str = ""

    @property
    def differs(self) -> bool:
        """Whether the firmware, or what the log holds of its commands, is not as its table says."""
        return self.lies_in not in (None, LiesIn.LOG, LiesIn.UNSEEN)


@dataclass(frozen=True)
class Estimate:
    """An estimated parameter of an effect, one standard deviation and its unit."""

    value: float
    sd: float
    unit: str


@dataclass(frozen=True)
class RankedHypothesis:
    """One effect or several jointly ("a.b + c.d"), what it depends on and acts on, how probable it is, and what looks the same."""

    effect: str
    class_: str
    probability: float
    parameters: Mapping[str, Estimate]
    ambiguous_with: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Its effects one by one."""
        return names_of(self.effect)


@dataclass(frozen=True)
class Unknown:
    """The chance that no candidate explains the gap; where it acts and on what it depends, None where there is nothing to place.

    `form` are the terms that sparse regression suggests ("d phi_dot/dt gains -0.2 sin(6 phi) rad/s^2"), where nothing else is likelier.
    """

    probability: float
    place: str | None = None
    class_: str | None = None
    form: str | None = None


@dataclass(frozen=True)
class Agreement:
    """How well one output's predictions agree with its readings, each figure by model variant ("nominal", "before", "after").

    `margin` is the tolerance in the output's unit, None where no rule gives one; `inside_margin` the shares of time within it.
    A figure that the data leave undefined is absent.
    """

    margin: float | None
    inside_margin: Mapping[str, float]
    correlation: Mapping[str, float]
    theil_fit_percent: Mapping[str, float]
    nrmse_fit_percent: Mapping[str, float]


@dataclass(frozen=True)
class ClosedLoop:
    """Flights of the log's own controller code on each model, against the logs: rms by output and input of what differs.

    `rms_floor` is what process noise and rounding alone make of it; `fraction` as for Shrinkage, over the outputs.
    `diverged` names the variants
    whose flight left the log's; their rms says no more than that it is large. `logs` are those that were flown again.
    """

    rms_nominal: Mapping[str, float]
    rms_before: Mapping[str, float]
    rms_after: Mapping[str, float]
    rms_floor: Mapping[str, float]
    fraction: float | None
    fraction_ci95: tuple[float, float] | None
    diverged: tuple[str, ...]
    logs: tuple[str, ...]


@dataclass(frozen=True)
class Shrinkage:
    """Errors of prediction on the hold-out logs by output, and which share of the removable error the effects remove.

    `agreement` tells of the same predictions by output and, under the name of its rate, of how fast it changes; `closed_loop` of
    flights by the logs' own controller, None where it is not at hand. `window_s` is how long each prediction runs.
    """

    rms_nominal: Mapping[str, float]
    rms_before: Mapping[str, float]
    rms_after: Mapping[str, float]
    rms_floor: Mapping[str, float]
    fraction: float | None
    fraction_ci95: tuple[float, float] | None
    agreement: Mapping[str, Agreement] = field(default_factory=dict)
    closed_loop: ClosedLoop | None = None
    window_s: float = 1.0


@dataclass(frozen=True)
class Diagnosis:
    """All of diagnosis.json; `firmware` is None where no log names a table, `shrinkage` where there is no hold-out log.

    `partly` is the probability that of the first hypothesis a part is right and another effect missing: with those of all hypotheses, of
    the unknown effect and of other parameters alone it makes 1. `verdict_reason` names the exit of the engine that was taken, `decisions`
    every rule that had a say on the way there, in order.
    `notes` are sentences, and `note_records` what each was made from, in the same order. `comparison` is what the probabilities follow
    from, None where no gap was told.
    """

    verdict: str
    false_alarm_probability: float | None
    places: tuple[PlaceShare, ...] = ()
    when: tuple[Span, ...] = ()
    regions: tuple[Region, ...] = ()
    bands: tuple[Band, ...] = ()
    error_responses: tuple[ErrorResponse, ...] = ()
    firmware: Firmware | None = None
    effects: tuple[RankedHypothesis, ...] = ()
    unknown: Unknown = Unknown(0.0)
    partly: float = 0.0
    found: tuple[str, ...] = ()
    shrinkage: Shrinkage | None = None
    next_experiment: Mapping[str, Any] | None = None
    notes: tuple[str, ...] = ()
    verdict_reason: str | None = None
    decisions: tuple[Decision, ...] = ()
    note_records: tuple[Note, ...] = ()
    comparison: ModelComparison | None = None


def diagnosis_text(diagnosis: Diagnosis, quality: Quality | None = None) -> str:
    """The record as JSON text in the form of CONTRACT.md, with its colour; raises BadInput for a number out of its range."""
    _check(diagnosis, "diagnosis")
    try:
        coloured = {} if quality is None else {QUALITY: quality_facts(quality)}
        return json.dumps({"schema": SCHEMA, **plain(diagnosis), **coloured}, indent=1, allow_nan=False) + "\n"
    except ValueError as error:
        raise BadInput("number", "diagnosis", str(error), "finite numbers", "write null for what is unknown") from error


def load_diagnosis(path: Path) -> Diagnosis:
    """Read diagnosis.json; raises BadInput naming file, key and remedy."""
    content = read_json(path, "diagnosis", "run `twinlaw diagnose`", "diagnose again")
    return parse_diagnosis(checks.table(content, str(path)), str(path))


def parse_diagnosis(content: Mapping[str, Any], where: str) -> Diagnosis:
    """A diagnosis from the content of its file; raises BadInput."""
    checks.schema(content, where, SCHEMA)
    known = {key_of(entry): entry for entry in fields(Diagnosis)}
    checks.keys(content, where, ("schema", *(key for key in known if key not in FURTHER)), (*FURTHER, QUALITY))
    given = {known[key].name: read(known[key].type, content[key], f"{where}: {key}") for key in known if key in content}
    diagnosis = Diagnosis(**given)
    _check(diagnosis, where)
    return diagnosis


def comparison_of(value: Any, where: str) -> ModelComparison:
    """A comparison from the content of its file; raises BadInput."""
    return record_of(ModelComparison, value, where)


def _check(diagnosis: Diagnosis, where: str) -> None:
    """Probabilities within 0..1, shares that sum to 1, known verdict."""
    if diagnosis.verdict not in VERDICTS:
        expected = " or ".join(map(repr, VERDICTS))
        raise BadInput("verdict", where, repr(diagnosis.verdict), expected, "give one of these")
    ranked = [hypothesis.probability for hypothesis in diagnosis.effects]
    for p in (*ranked, diagnosis.partly, diagnosis.unknown.probability, diagnosis.false_alarm_probability or 0.0):
        if not 0.0 <= p <= 1.0:
            raise BadInput("probability", where, repr(p), "a number from 0 to 1", "check how it was computed")
    for name in ("places", "when", "regions", "bands"):
        shares = [entry.share for entry in getattr(diagnosis, name)]
        if any(not 0.0 <= share <= 1.0 + SHARE_TOLERANCE for share in shares):
            raise BadInput(f"share of {name}", where, repr(shares), "numbers from 0 to 1", "scale them by their sum")
    total = sum(entry.share for entry in diagnosis.places)
    if diagnosis.places and abs(total - 1.0) > SHARE_TOLERANCE:
        raise BadInput("shares of places", where, f"a sum of {total:g}", "a sum of 1", "scale them by their sum")
