"""What a log that is watched is doubted for: a column that is likelier another, or rows that are not those of their time.

Elsewhere that is refused, as numbers would come of it; here a person looks on, and the gap shows it too.
"""

from logcheck.integrity import Integrity
from records.errors import BadInput
from records.log import RunLog
from records.reasons import DOUBTS
from sim.bind import BoundPlant
from twinlaw.workflows.columns import demand_columns_of


def columns_in_doubt(bound: BoundPlant, log: RunLog, looked: Integrity) -> tuple[str, ...]:
    """One sentence for each doubt of the columns of a log that was looked at; none where the plant as stated follows it."""
    try:
        notes = demand_columns_of(bound, log, looked)
    except BadInput as error:
        return (f"{error.got}; {error.remedy}",) if error.what == "columns" else ()
    return tuple(note.said for note in notes if note.kind in DOUBTS and note.said)
