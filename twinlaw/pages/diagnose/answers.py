"""By how much the rig answers its commands otherwise than the model, by frequency, for a page and for a terminal."""

from math import degrees

from identification import thresholds
from records.diagnosis import Diagnosis, ErrorResponse
from records.text.uncertain import with_sd
from twinlaw.pages.diagnose.words import shown
from twinlaw.pages.page import Section, Table


def answers_section(diagnosis: Diagnosis) -> Section | None:
    """A table of the error responses; None where the logs support none."""
    if not diagnosis.error_responses:
        return None
    rows = [
        (*_what(row), _band(row), _size(row), f"{degrees(row.phase_rad):.0f} deg", f"{row.coherence:.2f}")
        for row in diagnosis.error_responses
    ]
    return Section(
        "How the rig's answers differ",
        (
            "By how much a reading answers a command otherwise than the re-tuned model says, as a share of the model's own answer. "
            "At a phase about 0 deg the rig answers more strongly, about 180 deg more weakly, about -90 deg later.",
            f"Only where the commands account for more than {100 * thresholds.GOOD_COHERENCE:.0f} % of a reading's error, by its coherence "
            "with them.",
        ),
        (Table(rows, ("answer of", "to", "between", "differs by", "phase", "coherence")),),
    )


def surest_answer(diagnosis: Diagnosis) -> str:
    """The error response of the highest coherence in one line, where there is one."""
    row = max(diagnosis.error_responses, key=lambda row: row.coherence)
    output, u = _what(row)
    size = f"{_size(row)}, phase {degrees(row.phase_rad):.0f} deg (coherence {row.coherence:.2f})"
    return f"answers: {output} to {u} from {_band(row)} differs by {size}"


def _what(row: ErrorResponse) -> tuple[str, str]:
    return shown(row.output)[0], shown(row.input)[0]


def _band(row: ErrorResponse) -> str:
    return f"{row.from_Hz:g} to {row.to_Hz:g} Hz"


def _size(row: ErrorResponse) -> str:
    return f"{with_sd(100.0 * row.error, 100.0 * row.sd)} %"
