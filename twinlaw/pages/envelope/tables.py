"""The tables of seed 003 in our form, rows of text: Table 2.1 to 2.3, 3.1 to 3.10, 4.1 to 4.8, and the interpolation."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from identification.envelope.by_hand import Tried
from identification.envelope.check import FINAL, Check
from identification.envelope.criteria import (
    UNFITTED,
    WEIGHTS,
    Match,
    error_margins,
    outside_percent,
    passed,
    score_percent,
)
from identification.envelope.flights.flight import OUTPUTS, STATES
from identification.envelope.flights.multistep import DOUBLET, PULSE, STEPS_2311, STEPS_3211, band_Hz, spectrum
from identification.envelope.one_condition import ConditionResult
from identification.envelope.output_equation.outputs import METHODS
from identification.envelope.quality import check_looks
from identification.envelope.study import Study
from identification.margins import MARGINS, FOOT_m
from records.quality import Quality
from records.text.units import label
from twinlaw.pages.page import Row, Table

# Table 2.1 of the thesis, open loop at HA6000ft-50kts [%].
THESIS_FIT = (99.21, 99.51, 97.17, 99.42, 99.19, 99.55, 99.49, 99.38)
THESIS_CORRELATION = (99.99, 100.0, 99.84, 99.99, 99.99, 100.0, 100.0, 99.99)

INPUTS = {"2-3-1-1": STEPS_2311, "3-2-1-1": STEPS_3211, "doublet": DOUBLET, "pulse": PULSE}
Ways = Callable[[Check], Mapping[str, Sequence[Match]]]


def symbols(names: Sequence[str]) -> tuple[str, ...]:
    """Names without their units: u_m_s is u, A_x_m_s2 is A_x."""
    return tuple(name.partition("_m_s")[0].partition("_rad")[0] for name in names)


def input_rows(unit_s: float) -> Table:
    """What is told of the inputs in 1.2.1: breadth, energy, energy at zero frequency, how long the first step leads away from trim."""
    rows = []
    for name, steps in INPUTS.items():
        low, high = band_Hz(steps, unit_s, share=0.2)
        still = spectrum(np.zeros(1), steps, unit_s)[0] / unit_s**2
        octaves = f"{np.log2(high / low):.1f}" if low > 0.0 else "from 0 on"
        rows.append((name, f"{low:.3f} to {high:.3f}", octaves, f"{sum(steps)}", f"{still:.0f}", f"{steps[0]}"))
    heading = (
        "unit time 1 s",
        "band above a fifth of the peak [Hz]",
        "octaves",
        "energy [s]",
        "|U(0)|^2 [s^2]",
        "first step [s]",
    )
    return Table(rows, heading)


def open_loop(entry: ConditionResult) -> Table:
    """Table 2.1: fit and correlation one step ahead, of deviations from trim, of whole signals, and as the thesis states."""
    found, whole = entry.checks[0].open_loop, entry.checks[0].open_loop_whole
    rows = [
        ("fit [%]", *(f"{match.fit_percent:.2f}" for match in found)),
        ("fit [%], trim put back", *(f"{match.fit_percent:.2f}" for match in whole)),
        ("fit [%], thesis at HA6000ft-50kts", *(f"{value:.2f}" for value in THESIS_FIT)),
        ("correlation [%]", *(f"{100 * match.correlation:.2f}" for match in found)),
        ("correlation [%], thesis at HA6000ft-50kts", *(f"{value:.2f}" for value in THESIS_CORRELATION)),
        ("points outside [%]", *(f"{match.outside_percent:.2f}" for match in found)),
    ]
    return Table(rows, ("", *symbols(STATES)))


def tunings(checks: Sequence[Check], of: str) -> Table:
    """Tables 2.2 and 2.3: percentage of points outside the margins by state and way of tuning, mean over the checks `of` some flights."""
    rows = []
    for how in checks[0].states:
        shares = np.array([[match.outside_percent for match in check.states[how]] for check in checks])
        held, flights = sum(check.held[how] for check in checks), sum(len(check.data.x) for check in checks)
        rows.append(
            (how, *(f"{share:.1f}" for share in shares.mean(axis=0)), f"{shares.mean():.2f}", f"{held} of {flights}")
        )
    return Table(rows, (f"start, {of}: outside [%]", *symbols(STATES), "mean", "flights held 3 s"))


def by_hand(flight: Tried) -> Table:
    """Table 2.2 of a flight whose start was typed in: by tuning the start, then the percentage of points outside it leads to."""
    starts = [(f"start, {how}", *(f"{value:.4g}" for value in at.values()), "", "") for how, at in flight.start.items()]
    shares = [
        (
            f"outside [%], {how}",
            *(f"{match.outside_percent:.1f}" for match in found),
            f"{outside_percent(found):.2f}",
            "yes" if passed(found) else "no",
        )
        for how, found in flight.states.items()
    ]
    return Table([*starts, *shares], (flight.flight, *map(label, STATES), "mean", "held 3 s"))


def conditions(found: Study) -> Table:
    """2.4: what became of each condition."""
    rows = []
    for entry in found.conditions:
        own, others = entry.checks[0], entry.checks[1:]
        held = sum(check.held[FINAL] for check in others)
        rows.append(
            (
                entry.condition.name,
                f"{entry.row + 1}",
                f"{entry.open_loop.spectral_radius:.4f}",
                f"{entry.model.state.spectral_radius:.4f}",
                f"{outside_percent(own.states[FINAL]):.2f}",
                *(f"{outside_percent(check.states[FINAL]):.2f}" for check in others),
                f"{held} of {len(others)}",
                *_worst(entry.checks),
            )
        )
    most = max((len(row) for row in rows), default=0)
    padded = [(*row[:-3], *[""] * (most - len(row)), *row[-3:]) for row in rows]
    validations = ["valid. 1 [%]" if number == 0 else f"{number + 1} [%]" for number in range(most - 8)]
    radii = ("radius, open", "closed")
    heading = ("condition", "row", *radii, "ident. [%]", *validations, "held 3 s", "worst", "")
    return Table(padded, heading)


def _worst(checks: Sequence[Check]) -> tuple[str, str]:
    """The signal that is outside its margins most, and the colour of all."""
    quality = Quality(tuple(look for check in checks for look in check_looks(check)))
    most = max((look for look in quality.looks if look.value is not None), key=lambda look: look.value or 0.0)
    return f"{most.value:.1f} %", str(quality.colour)


def outputs_by_condition(found: Study) -> Table:
    """Tables 3.1 to 3.3: points outside by the classical and the linear equation on measured states, and the reduction."""
    rows = []
    for entry in found.conditions:
        ways = entry.checks[0].outputs
        shares = {way: [match.outside_percent for match in ways[way]] for way in ("classical", "linear")}
        fallen = [100.0 * (1.0 - b / a) if a > 0.0 else 0.0 for a, b in zip(*shares.values(), strict=True)]
        cells = [f"{value:.2f}" for values in shares.values() for value in values]
        rows.append((entry.condition.name, *cells, *(f"{value:.1f}" for value in fallen)))
    return Table(rows, ("condition [%]", *_by_group(("classical", "linear", "reduction"), symbols(OUTPUTS))))


def _by_group(groups: Sequence[str], names: Sequence[str]) -> list[str]:
    """Headings of columns that repeat by group: the group's name stands at its first."""
    return [f"{group}: {name}" if i == 0 else name for group in groups for i, name in enumerate(names)]


def averages(found: Study, ways: Ways) -> Table:
    """Tables 3.4 and 4.1: points outside, mean over conditions, identification and validations apart."""

    def cells(way: str, checks: Sequence[Check]) -> list[str]:
        shares = np.array([[match.outside_percent for match in ways(check)[way]] for check in checks])
        return [f"{value:.2f}" for value in shares.mean(axis=0)]

    rows = _by_method(found, cells, len(OUTPUTS))
    return Table(rows, ("equation [%]", *_by_group(("identification", "validation"), symbols(OUTPUTS))))


def errors(found: Study, ways: Ways) -> Table:
    """What no weight and no criterion of taste enters: the rms error in margins, mean over signals, and how often each way's is least."""

    def cells(way: str, checks: Sequence[Check]) -> list[str]:
        mean = np.mean([error_margins(ways(check)[way]) for check in checks])
        return [f"{mean:.3f}", f"{sum(_least(ways(check)) == way for check in checks)} of {len(checks)}"]

    rows = _by_method(found, cells, 2)
    return Table(rows, ("rms error [margins]", "identification", "least in", "validation", "least in"))


def _least(by_way: Mapping[str, Sequence[Match]]) -> str:
    return min(by_way, key=lambda way: error_margins(by_way[way]))


def weights() -> Table:
    """Table 3.5: criteria and their weights; ours, as the thesis' are not in the text."""
    return Table([(name, f"{weight:g}") for name, weight in WEIGHTS.items()], ("criterion", "weight"))


def scores(checks: Sequence[Check], ways: Ways) -> Table:
    """Tables 3.6 to 3.9 and 4.2 to 4.5: the weighted score of each flight by output equation."""
    rows = [(check.name, *(f"{score_percent(ways(check)[way]):.2f}" for way in METHODS)) for check in checks]
    return Table(rows, ("score [%]", *METHODS))


def goodness(found: Study, ways: Ways) -> Table:
    """Tables 3.10 and 4.8: mean score over all conditions, the same without Theil's fit, and how many checks hold three seconds."""

    def cells(way: str, checks: Sequence[Check]) -> list[str]:
        means = [np.mean([score_percent(ways(check)[way], by) for check in checks]) for by in (WEIGHTS, UNFITTED)]
        held = sum(passed(ways(check)[way]) for check in checks)
        return [*(f"{mean:.2f}" for mean in means), f"{held} of {len(checks)}"]

    rows = _by_method(found, cells, 3)
    return Table(
        rows, ("equation [%]", *_by_group(("identification", "validation"), ("score", "without fit", "held 3 s")))
    )


def interpolation(found: Study) -> tuple[Table, Table]:
    """4.4: flights of conditions left out, by the model between its neighbours, and by the nearest one's."""
    return (
        _left_out("between neighbours", [(entry.condition.name, entry.between) for entry in found.left_out]),
        _left_out("nearest model", [(entry.condition.name, entry.nearest) for entry in found.left_out]),
    )


def _left_out(title: str, checks: Sequence[tuple[str, Check]]) -> Table:
    rows, tunings = [], tuple(checks[0][1].states)
    for name, check in checks:
        shares = [f"{outside_percent(check.states[how]):.2f}" for how in tunings]
        held = f"{check.held[FINAL]} of {len(check.data.x)}"
        rows.append((name, *shares, held, f"{outside_percent(check.overall['linear']):.2f}", *_worst([check])))
    return Table(rows, (f"{title}: outside [%]", *tunings, "held 3 s", "accelerations", "worst signal", ""))


def margins() -> Table:
    """Table 1.1: the margins by mission, in the units of the thesis."""
    units = {
        "m_s": (FOOT_m, "ft/s"),
        "m_s2": (FOOT_m, "ft/s^2"),
        "rad_s": (np.radians(1.0), "deg/s"),
        "rad": (np.radians(1.0), "deg"),
    }
    rows = []
    for name in (*STATES, *OUTPUTS):
        symbol = symbols((name,))[0]
        scale, unit = units[name[len(symbol) + 1 :]]
        rows.append((f"{symbol} [{unit}]", *(f"{by_name[name] / scale:.4g}" for by_name in MARGINS.values())))
    return Table(rows, ("margin to either side", *MARGINS))


def _by_method(found: Study, cells: Callable[[str, Sequence[Check]], list[str]], width: int) -> list[Row]:
    """A row for each output equation: `width` cells of the identification flights, then as many of the validation flights."""
    return [
        (way, *(cell for checks in _groups(found) for cell in (cells(way, checks) if checks else [""] * width)))
        for way in METHODS
    ]


def _groups(found: Study) -> tuple[list[Check], list[Check]]:
    """All checks by identification flights, and all by validation flights."""
    return (
        [entry.checks[0] for entry in found.conditions],
        [check for entry in found.conditions for check in entry.checks[1:]],
    )
