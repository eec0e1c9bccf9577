"""What goes through a diagnosis: the logs that it is given, what is seen of a gap, how that is judged, and the answer."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.decide.holdout import Holdout
from diagnosis.decide.weighing import Weighed
from diagnosis.detect.detection import Detection
from diagnosis.detect.linearisation import Linearisation
from diagnosis.detect.score_tests import ScoreTest
from diagnosis.explain.curve import Shape
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.fit.gauss_newton import Fit
from diagnosis.hypothesis.case import Case
from diagnosis.search.beam import Search
from diagnosis.search.retune import Retune
from diagnosis.validate.shrinkage import Predicted
from records.diagnosis import Diagnosis, Firmware
from records.log import RunLog
from records.plant import Plant
from records.table import ControllerTable


@dataclass(frozen=True, eq=False)
class Material:
    """Logs to fit and logs to check on, with the names of both and the rows that may be used of each; `tables` are the controllers that
    flew the logs to check on, None where one is not at hand."""

    logs: Sequence[RunLog]
    holdout: Sequence[RunLog]
    holdout_names: Sequence[str]
    used: Sequence[NDArray[np.bool_] | None]
    firmware: Firmware | None = None
    notes: tuple[str, ...] = ()
    tables: Sequence[ControllerTable | None] = ()
    names: Sequence[str] = ()


@dataclass(frozen=True, eq=False)
class Seen:
    """What is seen before any cause is looked for: the plant re-tuned within its spread, the looks at the library beside it, the fit with
    lost frames, and what all that says of a gap; `checked` are the logs to check on."""

    case: Case
    checked: Case | None
    retuned: FittedHypothesis
    linearisation: Linearisation
    score_tests: tuple[ScoreTest, ...]
    lossy: Fit | None
    detection: Detection


@dataclass(frozen=True, eq=False)
class Judged:
    """What is made of a gap: all that was tried, the re-tune beyond the spread, how probable each is, what the hold-out leaves of the
    most probable (`chosen`, the plant without effects where it refutes all), and the notes so far."""

    search: Search
    beyond: Retune | None
    weighed: Weighed
    chosen: FittedHypothesis
    holdout: Holdout | None
    notes: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Result:
    """The record for diagnosis.json, the improved plant, and the arrays that a report shows: predictions by hold-out log, and the `shape`
    of an effect without a name."""

    diagnosis: Diagnosis
    plant: Plant
    case: Case
    predicted: tuple[Predicted, ...]
    shape: Shape | None = None
