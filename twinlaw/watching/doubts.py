"""What a log that is watched is doubted for: a column that is likelier another, or rows that are not those of their time.

Elsewhere that is refused, as numbers would come of it; here a person looks on, and the gap shows it too.
"""

import numpy as np

from logcheck.breaks import unbroken
from logcheck.integrity import Integrity, as_read
from records.errors import BadInput
from records.log import RunLog
from records.reasons import DOUBTS
from sim.bind import BoundPlant
from twinlaw.workflows.identify.columns import demand_columns


def columns_in_doubt(bound: BoundPlant, log: RunLog, looked: Integrity) -> tuple[str, ...]:
    """One sentence for each doubt of the columns of a log that was looked at; none where the plant as stated follows it."""
    if looked.refusals:
        return ()
    (entry,) = looked.logs
    try:
        parts = unbroken([as_read(log, entry)], [np.ones(len(log.t_s), bool)], [entry.begins], [entry.name])
        notes = demand_columns(bound, dict(zip(parts.names, parts.logs, strict=True)))
    except BadInput as error:
        return (f"{error.got}; {error.remedy}",) if error.what == "columns" else ()
    return tuple(note.said for note in notes if note.kind in DOUBTS and note.said)
