"""What goes through a diagnosis: the logs that it is given, what is seen of a gap, how that is judged, and the answer."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from diagnosis.decide.holdout import Holdout
from diagnosis.decide.weighing import Weighed
from diagnosis.detect.detection import Detection
from diagnosis.detect.linearisation import Linearisation
from diagnosis.detect.starts import ScoreTest
from diagnosis.explain.curve import Shape
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.linear_problem import Fit
from diagnosis.hypothesis.case import Case
from diagnosis.search.beam import Search
from diagnosis.search.free_curve import FittedCurve
from diagnosis.search.retune import Retune
from diagnosis.search.singles import Alone
from diagnosis.validate.shrinkage import Predicted
from records.diagnosis import Diagnosis, Firmware
from records.log import RunLog
from records.plant import Plant
from records.reasons import Decision, Note
from records.table import ControllerTable


class Exit(Enum):
    """The ends of the path, by the word that diagnosis.json has for each as `verdict_reason`."""

    NOTHING_SEEN = "nothing_seen"  # the logs are as those of the plant as stated
    TOO_LITTLE_SEEN = "too_little_seen"  # they are, and most of the library would not show in them
    YIELDING_EXPLAINS = "yielding_explains"  # axes that creep or give near rest, which is no gap, leave none
    UNEXPLAINED = "unexplained"  # a small gap that neither an effect of sure size nor parameters explain
    TOO_SMALL = "too_small"  # a gap whose explanations change no prediction by enough to matter
    TOO_UNSURE = "too_unsure"  # one whose explanation may change predictions by enough, but not surely
    EFFECT_ADDED = "effect_added"
    PARAMETERS_ALONE = "parameters_alone"
    NAMED_NOT_ADDED = (
        "named_not_added"  # the likeliest effect predicts the hold-out worse, or is unlikely and no better
    )
    UNKNOWN_EFFECT = "unknown_effect"


@dataclass(frozen=True, eq=False)
class Material:
    """Logs to fit and logs to check on, with the names of both and the rows that may be used of each; `tables` are the controllers that
    flew the logs to check on, None where one is not at hand."""

    logs: Sequence[RunLog]
    holdout: Sequence[RunLog]
    holdout_names: Sequence[str]
    used: Sequence[NDArray[np.bool_] | None]
    firmware: Firmware | None = None
    notes: tuple[Note, ...] = ()
    tables: Sequence[ControllerTable | None] = ()
    names: Sequence[str] = ()


@dataclass(frozen=True, eq=False)
class Seen:
    """What is seen before any cause is looked for: the plant re-tuned within its spread, score tests of the library beside it, None where
    nobody asked for them yet, the fit with lost frames, and what all that says of a gap; `beside` is what was fitted already, `checked`
    are the logs to check on, `decisions` the rules that had a say so far, `begun` its single effects where these were fitted, `still` the
    same from the plant without noise with a memory where that was looked at, `held` the logs with their inputs held from row to row where
    another reading is likelier."""

    case: Case
    checked: Case | None
    retuned: FittedHypothesis
    linearisation: Linearisation
    score_tests: tuple[ScoreTest, ...] | None
    lossy: Fit | None
    detection: Detection
    decisions: tuple[Decision, ...] = ()
    beside: FittedHypothesis | None = None
    begun: Alone | None = None
    still: "Seen | None" = None
    held: "HeldInputs | None" = None

    @property
    def tests(self) -> tuple[ScoreTest, ...]:
        """The score tests, which were asked for."""
        assert self.score_tests is not None
        return self.score_tests

    def because(self, *further: Decision) -> "Seen":
        """The same with further rules that had a say."""
        return replace(self, decisions=(*self.decisions, *further))


@dataclass(frozen=True, eq=False)
class HeldInputs:
    """The logs with inputs held from row to row, those to check on likewise, the plant's fit, and the nats by which several commands a row
    are likelier."""

    case: Case
    checked: Case | None
    fit: Fit
    beaten: float


@dataclass(frozen=True, eq=False)
class Judged:
    """What is made of a gap: all that was tried, the re-tune beyond the spread, the free curve, how probable each is, what the hold-out
    leaves of the most probable (`chosen`, the plant without effects where it refutes all), and the notes so far."""

    search: Search
    beyond: Retune | None
    curve: FittedCurve | None
    weighed: Weighed
    chosen: FittedHypothesis
    holdout: Holdout | None
    notes: tuple[Note, ...]


@dataclass(frozen=True, eq=False)
class Result:
    """The record for diagnosis.json, the improved plant, and the arrays that a report shows: predictions by hold-out log, the `shape`
    of an effect without a name, and the hold-out logs as they were `checked`."""

    diagnosis: Diagnosis
    plant: Plant
    case: Case
    predicted: tuple[Predicted, ...]
    shape: Shape | None = None
    checked: Case | None = None
