"""The report of `twinlaw identify --method frequency`: matrices, pairs, Figs. 2, 3, 5 and 6 of seed 002 redrawn."""

from collections.abc import Mapping

import numpy as np

from identification import thresholds
from identification.frequency.flights.transfer import off_at_the_ends
from identification.frequency.lateral import MODEL as LATERAL
from identification.frequency.models.lateral_record import LateralFlight
from identification.frequency.quality import frequency_quality
from identification.frequency.result import FrequencyIdentification, TimeCheck
from identification.frequency.truth import Truth
from twinlaw.pages.identify.frequency_plots import SWEEP, TRANSFER, check_name, response_name
from twinlaw.pages.identify.frequency_tables import (
    CHECK_HEADING,
    check_rows,
    cost_text,
    element_tables,
    matrix_tables,
    pair_heading,
    pair_rows,
)
from twinlaw.pages.identify.summary import SCALE, estimate_heading, estimate_rows, remarked
from twinlaw.pages.page import Page, Section, Table, as_sentence
from twinlaw.pages.quality import quality_section, quality_sentence


def frequency_page(
    found: FrequencyIdentification,
    plots: Mapping[str, str],
    truth: Truth | None = None,
    flown: LateralFlight | None = None,
) -> Page:
    """The whole page; `plots` are its pictures by name, the `truth` stands beside what was found; `flown` is a flight of a helicopter."""
    estimates = found.result.estimates
    told = sum(entry.identified for entry in estimates)
    quality = frequency_quality(found, truth)
    sections = [
        _parameters(found, truth),
        _matrices(found, truth),
        *([] if flown is None else [_flown(flown, plots)]),
        _responses(found, plots, truth),
        *(_check(found, check, plots) for check in found.checks),
        quality_section(quality),
    ]
    return Page(
        title=f"{found.result.plant.name}: identified in the frequency domain",
        verdict=f"{found.warning}. " * bool(found.warning)
        + f"{told} of {len(estimates)} parameters identified; cost J = {cost_text(found.fit.J)}; {remarked(len(found.notes))}.",
        colour=quality.colour,
        why=quality_sentence(quality),
        facts=(("Equations", found.result.plant.model),),
        sections=tuple(sections),
    )


def _parameters(found: FrequencyIdentification, truth: Truth | None) -> Section:
    known = None if truth is None else truth.values
    estimates = found.result.estimates
    rows = estimate_rows(estimates, found.fit.at_bound, known)
    return Section(
        "Parameters",
        (*map(as_sentence, found.notes or ("Nothing to remark.",)), SCALE),
        (Table(rows, estimate_heading(known)),),
    )


def _matrices(found: FrequencyIdentification, truth: Truth | None) -> Section:
    """A and B with what they may be off by."""
    about = "trim" if _is_of_paper(found) else "rest point"
    sentence = (
        f"x' = A x + B u about the {about}, of the values that plant.toml holds; each element with its 95 % interval, none where it is "
        "known. An element's unit is that of its row over that of its column."
    )
    tables = [*matrix_tables(found), *([] if truth is None else element_tables(found, truth))]
    return Section(f"The identified A and B{_as_in(found, ', eq (8)')}", (sentence,), tuple(tables))


def _is_of_paper(found: FrequencyIdentification) -> bool:
    return found.result.plant.model == LATERAL


def _as_in(found: FrequencyIdentification, place: str) -> str:
    """The place of the paper that a section redraws, where the plant is the paper's."""
    return place if _is_of_paper(found) else ""


def _flown(flown: LateralFlight, plots: Mapping[str, str]) -> Section:
    """Figs. 2 and 3."""
    moved = flown.transferred
    removed = float(np.std((moved.turning_m_s2 + moved.centripetal_m_s2)[:, 1]))
    sentences = (
        f"The record {flown.name}: what the pilot swept and how the helicopter rolls.",
        f"Then the lateral acceleration, carried from the accelerometer to the centre of gravity: {removed:.2g} m/s^2 rms is taken off. "
        f"The rates are smoothed at {thresholds.BANDWIDTH_rad_s:g} rad/s for it; by their stated noise that adds "
        f"{flown.noise_m_s2:.2g} m/s^2 rms. At the record's first and last reading their slope is off by up to "
        f"{100.0 * off_at_the_ends(1.0):.1f} % of a motion at 1 rad/s, by {100.0 * off_at_the_ends(2.0):.0f} % at 2 rad/s.",
    )
    return Section("A sweep as it was flown (Figs. 2 and 3)", sentences, (), (plots[SWEEP], plots[TRANSFER]))


def _responses(found: FrequencyIdentification, plots: Mapping[str, str], truth: Truth | None) -> Section:
    fit = found.fit
    sentences = (
        "Conditioned frequency responses from windows of "
        + ", ".join(f"{entry.length_s:.3g}" for entry in fit.responses.windows)
        + " s; points are those that were matched. A dotted line is the plant file as it was.",
        f"Secant searches from {len(fit.searches)} start{'s' if len(fit.searches) > 1 else ''} ended at a cost J of "
        + ", ".join(f"{entry.J:.4g}" for entry in fit.searches)
        + f", before finite windows were corrected for; with that it is {fit.J:.4g}.",
        "Misfit is what the model leaves over what random errors explain, both rms.",
    )
    shown = tuple(plots[response_name(name)] for name in fit.model.outputs)
    return Section(
        f"Frequency responses{_as_in(found, ' (Fig. 5)')}",
        sentences,
        (Table(pair_rows(found, truth), pair_heading(truth)),),
        shown,
    )


def _check(found: FrequencyIdentification, check: TimeCheck, plots: Mapping[str, str]) -> Section:
    """How a record that was not matched is predicted."""
    anew = "" if np.isinf(check.window_s) else f" It starts anew every {check.window_s:g} s, as the loop was closed."
    sentence = f"A record that was not matched: the identified model under its inputs; start and trim are fitted, nothing else.{anew}"
    return Section(
        f"Verification in time: {check.name}{_as_in(found, ' (Fig. 6)')}",
        (sentence,),
        (Table(check_rows((check,), found.fit.model.outputs), CHECK_HEADING),),
        (plots[check_name(check)],),
    )
