"""What was mended of a file as it was read: every row that is not as it stands there, or not there any more."""

from dataclasses import dataclass

from records.logs.coarse_stamps import Spread
from records.logs.restarts import Restart
from records.logs.unwritten import Unwritten
from records.text.last_row import HalfRow


@dataclass(frozen=True)
class Disordered:
    """Rows of a file whose time does not rise: how many, the first one's time; and where the log goes on behind such as are no row
    written again, with how many these were."""

    rows: int
    first_s: float
    went_back: tuple[tuple[float, int], ...] = ()


@dataclass(frozen=True)
class LateInput:
    """An input that begins at `begins_s`, behind so many rows of a recording in which the outputs alone stand; these are left out."""

    column: str
    begins_s: float
    rows: int


@dataclass(frozen=True)
class Mended:
    """What was mended: `restarts` are where another recording of the same file begins, whose times are counted on; `late_inputs` begin
    behind a recording's first row; `disordered` and `unwritten` are rows of the file that were left out, `spread` those whose stamps were
    too coarse to tell them apart, `half_row` the last one where it was written in part."""

    restarts: tuple[Restart, ...] = ()
    late_inputs: tuple[LateInput, ...] = ()
    disordered: Disordered | None = None
    unwritten: Unwritten | None = None
    spread: Spread | None = None
    half_row: HalfRow | None = None
