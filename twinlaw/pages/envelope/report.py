"""The report of `twinlaw envelope`: the tables and figures of seed 003 in our form."""

from collections.abc import Sequence
from typing import Any

from identification.envelope.by_hand import Tried
from identification.envelope.check import FINAL, Check
from identification.envelope.criteria import outside_percent
from identification.envelope.modes import Mode
from identification.envelope.one_condition import ConditionResult, Interpolated
from identification.envelope.quality import envelope_quality
from identification.envelope.record import summary
from identification.envelope.study import Study
from twinlaw.pages.envelope import models, plots, tables
from twinlaw.pages.page import Page, Section, Table
from twinlaw.pages.quality import quality_section, quality_sentence

THEIL_AND_NOISE = (
    "The rms error needs no weights. Theil's fit of a signal that is mostly noise, as A_x and A_y are here, ranks badly: an estimate as "
    "large as the noise and unrelated to it has a fit of 29 %, one that stays at the trim 0 %."
)


def envelope_page(
    found: Study, origin: str, by_hand: Sequence[Tried] = (), show: str | None = None, modes: Sequence[Mode] = ()
) -> Page:
    """The whole page; `origin` says where the flights came from, `by_hand` tells of starts that were typed in, `show` names the condition
    that is drawn, by default the worst."""
    entry, told = shown(found, show), summary(found)
    quality = envelope_quality(found)
    drawn = entry.condition.name + ("" if show else ", the worst; another by --show CONDITION")
    return Page(
        title="Models over the flight envelope",
        verdict=verdict(told),
        colour=quality.colour,
        why=quality_sentence(quality),
        facts=(("Flights", origin), ("Shown", drawn)),
        sections=(
            _inputs(entry, found),
            _open_loop(entry),
            _closed_loop(entry, found),
            *([_by_hand(by_hand)] if by_hand else []),
            *(_validation(check, entry) for check in entry.checks[1:]),
            _all_conditions(found),
            _models(found, modes),
            _output_equation(entry, found),
            _global_model(entry, found),
            *([_interpolation(found)] if found.left_out else []),
            quality_section(quality),
        ),
    )


def shown(found: Study, name: str | None) -> ConditionResult:
    """The condition of that name, by default the one whose worst signal leaves its margins most."""
    if name is None:
        return max(
            found.conditions, key=lambda entry: max(m.outside_percent for c in entry.checks for m in c.states[FINAL])
        )
    return next(entry for entry in found.conditions if entry.condition.name == name)


def verdict(told: dict[str, Any]) -> str:
    """How many flights keep the three-second rule, group by group."""
    parts = [
        f"{group['held_three_seconds']} of {group['flights']} flights of {name}"
        for name, group in told.items()
        if group["flights"]
    ]
    return f"All states within the FAA's margins for three seconds: {', '.join(parts)}."


def notes_of(found: Study) -> tuple[str, ...]:
    """What the flights of each condition cannot tell, and those that served nothing."""
    told = [f"{entry.condition.name}: {note}." for entry in found.conditions for note in entry.notes]
    return (*told, *(f"{note}." for note in found.unused))


def _inputs(entry: ConditionResult, found: Study) -> Section:
    return Section(
        "Manoeuvres and margins (1.2, Table 1.1)",
        (
            "Multistep inputs cover more octaves than a doublet, at 3.5 times its energy, and can be flown by hand. Both are asymmetric, "
            "so some energy lies at zero frequency; the 2-3-1-1 begins with a shorter step than its longest, nearer to trim.",
            f"The four manoeuvres of {entry.condition.name} one after the other, as deviations from each flight's trim; the other "
            "controls move too, as the pilot steadies the machine.",
        ),
        (tables.input_rows(1.0), tables.margins()),
        (plots.inputs(), plots.points(found), plots.controls(entry.checks[0])),
    )


def _open_loop(entry: ConditionResult) -> Section:
    return Section(
        "State equation, open loop (2.2, Table 2.1)",
        (
            "Recursive least squares, one model after each row; the one of highest potential is kept. Each state is predicted one sample "
            "ahead from measured ones. Theil's fit of whole signals flatters, as the trim is predicted for nothing.",
            "The free runs' error, middle, leaps where the windows grow, from 2 s over 6 s to the whole flight.",
        ),
        (tables.open_loop(entry),),
        (plots.training(entry),),
    )


def _closed_loop(entry: ConditionResult, found: Study) -> Section:
    own, others = entry.checks[:1], entry.checks[1:]
    everywhere = [check for condition in found.conditions for check in condition.checks[1:]]
    flights = {
        f"identification of {entry.condition.name}": own,
        f"validations of {entry.condition.name}": others,
        "validations of all conditions": everywhere,
    }
    return Section(
        "State equation, closed loop (2.3, Tables 2.2 and 2.3)",
        (
            "The model runs on the pilot's controls alone. Points outside the margins in per cent, by how the start was tuned: not at all, "
            "by hand where starts were typed in, state by state over a grid, automatically within bounds, and automatically with the "
            "error of the trim.",
        ),
        tuple(tables.tunings(checks, of) for of, checks in flights.items() if checks),
        (plots.states(entry.checks[0], entry),),
    )


def _by_hand(flights: Sequence[Tried]) -> Section:
    checks = tuple(dict.fromkeys(entry.check for entry in flights))
    return Section(
        "Starts typed in (2.3.3.1, Table 2.2)",
        (
            "Of each flight whose start was typed in: the starts of all tunings, and the points outside the margins in per cent.",
        ),
        tuple(tables.by_hand(entry) for entry in flights),
        tuple(plots.states(check, None, "by hand") for check in checks),
    )


def _validation(check: Check, entry: ConditionResult) -> Section:
    return Section(f"Validation: {check.name}", (), (), (plots.states(check, entry),))


def _all_conditions(found: Study) -> Section:
    return Section(
        "All flight conditions (2.4)",
        (
            f"Row of the recursion that was chosen, spectral radius per sample of the open and the closed loop's model; then the mean "
            f"percentage of points outside over the eight states, starts tuned {FINAL}.",
            *notes_of(found),
        ),
        (tables.conditions(found),),
    )


def _models(found: Study, modes: Sequence[Mode]) -> Section:
    known = any(mode.truth is not None for mode in modes)
    beside = " The truth is the exact derivatives of the simulated helicopter's equations." if known else ""
    everything: list[ConditionResult | Interpolated] = [*found.conditions, *found.left_out]
    return Section(
        "Modes, and A, B, C and D by condition",
        (
            f"The slowest oscillation, the phugoid, and the fastest, the Dutch roll, as eigenvalues.{beside}",
            "The next x is A x + B u, a sample later, and y = C x + D u, all of deviations from trim; an element's unit is that of its row "
            "over that of its column. The matrices of each condition, A B over C D, open at a click.",
        ),
        (
            *([models.modes_off(modes)] if known else []),
            *([models.modes(modes)] if modes else []),
            *(models.matrices(entry) for entry in everything),
        ),
        (models.modes_plot(modes),) if modes else (),
    )


def _output_equation(entry: ConditionResult, found: Study) -> Section:
    return Section(
        "Output equation (chapter 3, Tables 3.1 to 3.10)",
        (
            f"Accelerations from measured states in three ways; the fuzzy system of {entry.condition.name} has "
            f"{len(entry.fuzzy.system.centre)} rules. The weights of the criteria are ours.",
            THEIL_AND_NOISE,
        ),
        (
            tables.outputs_by_condition(found),
            tables.averages(found, lambda check: check.outputs),
            tables.errors(found, lambda check: check.outputs),
            tables.weights(),
            tables.scores(entry.checks, lambda check: check.outputs),
            tables.goodness(found, lambda check: check.outputs),
        ),
        (plots.accelerations(entry.checks[0], overall=False),),
    )


def _global_model(entry: ConditionResult, found: Study) -> Section:
    sections: tuple[Table, ...] = (
        tables.averages(found, lambda check: check.overall),
        tables.errors(found, lambda check: check.overall),
        tables.scores(entry.checks, lambda check: check.overall),
        tables.goodness(found, lambda check: check.overall),
    )
    return Section(
        "Global model (4.1 to 4.3, Tables 4.1 to 4.8)",
        ("Accelerations from the states of the free run, so from the pilot's controls alone.",),
        sections,
        (plots.accelerations(entry.checks[0], overall=True),),
    )


def _interpolation(found: Study) -> Section:
    worst = max(found.left_out, key=lambda entry: outside_percent(entry.between.states[FINAL]))
    return Section(
        "Interpolation over the speed (4.4)",
        (
            "Conditions of which no flight was used: each element of A, B, C and D lies straight between its neighbours in speed. Beside "
            "it the model of the nearest speed, without interpolation.",
            f"The picture shows the worst of them, {worst.condition.name}.",
        ),
        tables.interpolation(found),
        (plots.states(worst.between, None),),
    )
