"""All that a diagnosis found: the record for diagnosis.json, the improved plant, and the arrays that a report shows."""

from dataclasses import dataclass

from diagnosis.case import Case
from diagnosis.curve import Shape
from diagnosis.detect import Detection
from diagnosis.search import Search
from diagnosis.shrinkage import Predicted
from diagnosis.trial import Tried
from diagnosis.unknown import Suspect
from diagnosis.weigh import Weighed
from records.diagnosis import Diagnosis
from records.plant import Plant


@dataclass(frozen=True, eq=False)
class Result:
    """`left` nats are what forms still gain beside the best hypothesis; `chosen` is the hypothesis whose effects were added (the nominal
    plant re-tuned where none was), `predicted` by hold-out log, `shape` that of an effect without a name."""

    diagnosis: Diagnosis
    plant: Plant
    case: Case
    detection: Detection
    search: Search | None
    weighed: Weighed | None
    left: float
    suspects: tuple[Suspect, ...]
    chosen: Tried
    predicted: tuple[Predicted, ...]
    shape: Shape | None = None
