"""The comparison as rows of text: what `twinlaw compare` prints and its page repeats."""

import math
from collections.abc import Mapping, Sequence

from records.board import STM32G071
from records.loops import Loop
from records.text.units import shown, unit_of
from twinlaw.pages.compare.comparison import Compared, spread_of
from twinlaw.pages.compare.quality import axis_looks, controller_quality
from twinlaw.pages.measured import settling_text, small
from twinlaw.pages.page import Row
from twinlaw.pages.quality import colour_of, quality_sentence
from verification.comparison.eq26 import FormError
from verification.comparison.measures import Merit

MERIT_HEADING: Row = (
    "controller",
    "overshoot",
    "settling",
    "steady error",
    "largest error",
    "IAE",
    "swing",
    "travel",
    "reversals",
)
SPREAD_HEADING: Row = (
    "controller",
    "settled",
    "overshoot",
    "settling",
    "steady error",
    "IAE, median / worst",
    "swing",
    "travel, reversals, median",
    "colour",
)
QUALITY_HEADING: Row = ("controller", "colour", "why")
EQ26_HEADING: Row = ("eq (26) in float32", "axis", "coefficients", "Q(1)", "slowest pole over the range")


def cost_heading(rows: Sequence[Compared]) -> Row:
    """Of the rows of cost_rows."""
    return (
        "controller",
        "cycles",
        f"of {1e3 * _period_s(rows[0]):g} ms",
        "stack",
        "flash",
        "RAM",
        "twin = host = target",
    )


def _period_s(row: Compared) -> float:
    t_s = next(iter(row.flights.values())).t_s
    return float(t_s[-1] - t_s[0]) / (t_s.size - 1)


def cost_rows(rows: Sequence[Compared]) -> list[Row]:
    """What one control step and the image cost."""
    return [
        (
            row.row.name,
            f"{row.cost.cycles_max}",
            f"{100.0 * row.cost.cycles_max / (STM32G071.clock_hz * _period_s(row)):.1f} %",
            f"{row.cost.stack_bytes} B",
            f"{row.cost.flash_bytes} B",
            f"{row.cost.ram_bytes} B",
            _equal(row),
        )
        for row in rows
    ]


def _equal(row: Compared) -> str:
    steps = min(entry.steps for entry in row.equality)
    return f"{sum(entry.mismatches for entry in row.equality)} of {steps} steps differ"


_ROUNDING = 11  # decimals in SI units, beyond which a mean over seconds is rounding of its steps
EQ26_FORMS = {"plain": "seven equations in powers of z^-1", "closed": "as on the board"}


def eq26_rows(errors: Mapping[tuple[str, str], FormError]) -> list[Row]:
    """Largest relative errors of each form and axis, and where its slowest pole lies."""
    return [
        (
            EQ26_FORMS[form],
            axis,
            f"{error.coefficients:.1e}",
            f"{error.q_sum:.1e}",
            f"{error.fastest_rad_s:+.4f} .. {error.slowest_rad_s:+.4f} rad/s",
        )
        for (form, axis), error in errors.items()
    ]


def figure_rows(rows: Sequence[Compared], figure: str, loop: Loop) -> list[Row]:
    """The merits of one axis in one figure."""
    return [(row.row.name, *_merit(row.figures[figure][loop.axis], loop)) for row in rows]


def _merit(merit: Merit, loop: Loop) -> Row:
    unit = unit_of(loop.input)
    return (
        f"{100.0 * merit.overshoot:.1f} %",
        settling_text(merit.settling_s),
        measured(loop, merit.steady_error_rad),
        measured(loop, merit.largest_error_rad),
        f"{integral(loop, merit.iae_rad_s)} {shown(loop.output)[0]} s",
        f"{small(merit.swing_V)} {unit}".rstrip(),
        f"{small(merit.travel_V_s)} {unit}/s",
        f"{merit.reversals_1_s:.1f} /s",
    )


def measured(loop: Loop, value: float) -> str:
    """An error as a person reads it: two decimals of a degree, three digits of anything else."""
    unit, scale = shown(loop.output)
    return f"{scale * value:.2f} {unit}" if unit == "deg" else f"{round(value, _ROUNDING):.3g} {unit}"


def integral(loop: Loop, value: float) -> str:
    """An IAE in the unit of `measured` times seconds, without it: whole degrees, three digits of anything else."""
    unit, scale = shown(loop.output)
    return f"{scale * value:.0f}" if unit == "deg" else f"{value:.3g}"


def spread_rows(rows: Sequence[Compared], loop: Loop) -> list[Row]:
    """One axis over the spread plants."""
    output_unit, input_unit = shown(loop.output)[0], unit_of(loop.input)
    shown_rows: list[Row] = []
    for row in rows:
        found, runs = spread_of(row.spread, loop.axis), len(row.spread)
        iae = f"{integral(loop, found.median_iae_rad_s)} / {integral(loop, found.worst_iae_rad_s)} {output_unit} s"
        shown_rows.append(
            (
                row.row.name,
                f"{runs - found.unsettled} of {runs}",
                f"{100.0 * found.worst_overshoot:.1f} %",
                settling_text(found.worst_settling_s),
                measured(loop, found.worst_steady_error_rad),
                iae,
                f"{small(found.worst_swing_V)} {input_unit}".rstrip(),
                f"{small(found.median_travel_V_s)} {input_unit}/s, {found.median_reversals_1_s:.1f} /s",
                colour_of(axis_looks(row, loop)),
            )
        )
    return shown_rows


def quality_rows(rows: Sequence[Compared]) -> list[Row]:
    """The colour of each controller on the spread plants, and why."""
    found = [(row.row.name, controller_quality(row)) for row in rows]
    return [(name, str(quality.colour), quality_sentence(quality)) for name, quality in found]


def filter_rows(rows: Sequence[Compared], loop: Loop) -> tuple[Row, list[Row]]:
    """Heading and rows: per reference filter and controller, median IAE and the worst overshoot."""
    heading = ("filter", *(row.row.name for row in rows))
    shares = rows[0].filters if rows else ()
    return heading, [(share(part), *(_tracked(row.filters[part], loop) for row in rows)) for part in shares]


def share(part: float) -> str:
    """A reference filter in words: its share of the plant file's time constant."""
    return f"{100.0 * part:.0f} % of T" if part else "no filter"


def _tracked(flown: Sequence[Mapping[str, Merit]], loop: Loop) -> str:
    found = spread_of(flown, loop.axis)
    lost = f", {found.unsettled} unsettled" if found.unsettled else ""
    iae = f"{integral(loop, found.median_iae_rad_s)} {shown(loop.output)[0]} s"
    return f"{iae}, {100.0 * found.worst_overshoot:.1f} %{lost}"


def effect_rows(rows: Sequence[Compared], figure: str) -> tuple[Row, list[Row]]:
    """Heading and rows: per effect and controller, IAE and the largest steady error of each axis; first `figure` without an effect."""
    heading = ("effect", *(row.row.name for row in rows))
    lines = [
        (effect, *(_struck(row, row.effects[effect]) for row in rows)) for effect in (rows[0].effects if rows else ())
    ]
    nominal = ("none", *(_struck(row, row.figures[figure]) for row in rows))
    return heading, [nominal, *lines]


def _struck(row: Compared, merits: Mapping[str, Merit]) -> str:
    """IAE of all axes, and the larger steady error where all are angles, else each one's; `unsettled` where a step never settles."""
    iae = " / ".join(integral(loop, merits[loop.axis].iae_rad_s) for loop in row.loops)
    unsettled = any(merit.settling_s is None for merit in merits.values())
    if {loop.output_unit for loop in row.loops} == {"rad"}:
        steady = f"{math.degrees(max(merit.steady_error_rad for merit in merits.values())):.1f} deg"
    else:
        steady = " / ".join(measured(loop, merits[loop.axis].steady_error_rad) for loop in row.loops)
    return f"{iae}, {steady}{' (unsettled)' if unsettled else ''}"
