"""An identification in the frequency domain as rows of text: pairs, records checked on, the elements of A and B."""

from collections.abc import Sequence

import numpy as np

from identification.frequency.models.elements import StateSpaces, state_space_with_sd
from identification.frequency.pairs import Pair, apart
from identification.frequency.quality import check_looks
from identification.frequency.result import FrequencyIdentification, TimeCheck
from identification.frequency.truth import Truth
from identification.results.result import NORMAL
from records.quality import MISFIT
from records.text.uncertain import EXACT, interval, to_sd
from records.text.units import label, stem, unit_of
from twinlaw.pages.identify.truth import HEADING as TRUTH_HEADING
from twinlaw.pages.identify.truth import off, told, z
from twinlaw.pages.measured import measured
from twinlaw.pages.page import Row, Table
from twinlaw.pages.quality import colour_of

PAIR_HEADING = (
    "input",
    "output",
    "matched over",
    "coherence",
    "cost J",
    "misfit",
    "model off by",
    "plant file off by",
)
CHECK_HEADING = ("record", "output", "rms", "sensor alone", "fit", "fit of the plant file", "")
ROUNDING = 1e-9


def cost_text(J: float) -> str:
    """A cost J, of which the field calls 100 good: to a tenth, of a smaller one two digits."""
    return f"{J:.1f}" if J >= 0.1 else f"{J:.2g}"


def pair_heading(truth: Truth | None) -> Row:
    """Of `pair_rows`."""
    return (*PAIR_HEADING, *(() if truth is None else ("off the truth by",)), "")


def pair_rows(found: FrequencyIdentification, truth: Truth | None) -> list[Row]:
    """One row for each input and output."""
    rows: list[Row] = []
    for place, pair in enumerate(found.pairs):
        output, input = divmod(place, len(found.fit.model.inputs))
        known = () if truth is None else (_off_truth(found, truth, pair, output, input),)
        rows.append((*_pair_cells(pair), *known, _pair_colour(pair)))
    return rows


def _pair_cells(pair: Pair) -> Row:
    if not pair.points:
        return (pair.input, pair.output, "not matched", f"{pair.coherence:.2f} at most", "", "", "", "")
    return (
        pair.input,
        pair.output,
        f"{pair.from_rad_s:.3g} .. {pair.to_rad_s:.3g} rad/s",
        f"{pair.coherence:.3f}",
        cost_text(pair.J),
        f"{pair.misfit:.2f}",
        f"{pair.left_dB:.2f} dB, {pair.left_deg:.1f} deg",
        f"{pair.stated_dB:.2f} dB, {pair.stated_deg:.1f} deg",
    )


def _pair_colour(pair: Pair) -> str:
    return colour_of([MISFIT.look(pair.output, pair.misfit)] if pair.points else [])


def _off_truth(found: FrequencyIdentification, truth: Truth, pair: Pair, o: int, i: int) -> str:
    """Over the points that were matched."""
    if not pair.points:
        return ""
    k = found.fit.points.frequency[(found.fit.points.output == o) & (found.fit.points.input == i)]
    dB, deg = apart(truth.T[k, o, i], found.T[k, o, i])
    return f"{dB:.2f} dB, {deg:.1f} deg"


def check_rows(checks: Sequence[TimeCheck], outputs: tuple[str, ...]) -> list[Row]:
    """One row for each output of each record that was not matched."""
    return [
        (
            check.name,
            output,
            measured(rms, output),
            measured(noise, output),
            f"{100.0 * fit:.1f} %",
            f"{100.0 * stated:.1f} %",
            str(look.colour),
        )
        for check in checks
        for output, rms, noise, fit, stated, look in zip(
            outputs, check.rms, check.noise, check.fit, check.stated_fit, check_looks(check, outputs), strict=True
        )
    ]


def matrix_tables(found: FrequencyIdentification) -> tuple[Table, Table]:
    """A and B, rows and columns with their units."""
    model, of = found.fit.model, _of(found)
    return _matrix(of, "A", model.states, model.states), _matrix(of, "B", model.states, model.inputs)


def _of(found: FrequencyIdentification) -> StateSpaces:
    return state_space_with_sd(found.fit.model, found.theta, found.covariance)


def _matrix(of: StateSpaces, name: str, states: Sequence[str], columns: Sequence[str]) -> Table:
    values, sds = getattr(of.value, name), getattr(of.sd, name)
    least = ROUNDING * float(np.max(sds))
    rows = [
        (
            _rate(state),
            *(
                f"{to_sd(value, sd)} ± {to_sd(NORMAL * sd, sd)}" if sd > least else f"{value:.{EXACT}g}"
                for value, sd in zip(line, own, strict=True)
            ),
        )
        for state, line, own in zip(states, values, sds, strict=True)
    ]
    return Table(rows, (name, *map(label, columns)))


def _rate(state: str) -> str:
    """ "p' [rad/s^2]" of p_rad_s."""
    unit = unit_of(state)
    return (
        f"{stem(state)}' [{unit.removesuffix('/s')}/s^2]"
        if unit.endswith("/s")
        else f"{stem(state)}' [{unit or '1'}/s]"
    )


def element_tables(found: FrequencyIdentification, truth: Truth) -> list[Table]:
    """Each element that was estimated beside the truth, the error in standard deviations."""
    of, model = _of(found), found.fit.model
    rows: list[Row] = []
    for name, columns in (("A", model.states), ("B", model.inputs)):
        values, sds, true = getattr(of.value, name), getattr(of.sd, name), getattr(truth.of, name)
        least = ROUNDING * float(np.max(sds))
        for i, j in zip(*np.nonzero(sds > least), strict=True):
            value, sd, known = float(values[i, j]), float(sds[i, j]), float(true[i, j])
            element = f"{name}: {_rate(model.states[i])} by {label(columns[j])}"
            within = interval(value - NORMAL * sd, value + NORMAL * sd, sd)
            rows.append(
                (element, to_sd(value, sd), within, told(known, sd), off(value, known, ""), z(value, sd, known))
            )
    return [Table(rows, ("element", "value", "95 % interval", *TRUTH_HEADING))]
