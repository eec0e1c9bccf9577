"""What shows that an identification is right: searches side by side, and the real plant beside the identified one where it is known."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from design.structure import missing
from identification.experiments.table import KINDS
from identification.experiments.velagic.figures import responses
from identification.proof.linear_rotor import against_linear, linear_rotor
from identification.proof.validation import compare_flights
from identification.results.result import Identification
from identification.stages.estimate import Estimate
from records.errors import BadInput
from records.experiment import Experiment
from sim.bind import BoundPlant, bind
from twinlaw.cli import console
from twinlaw.pages.identify.report import ROTORS, flight_section
from twinlaw.pages.identify.search import evolution_plot, search_sections
from twinlaw.pages.identify.velagic import figure_plots, figure_section
from twinlaw.pages.page import Section


@dataclass(frozen=True)
class ProofReport:
    """Sections of the report, pictures (SVG text) by the number of the paper's figure, and rms differences of both flights by column."""

    sections: Sequence[Section]
    pictures: Mapping[str, str]
    flight_rms: Mapping[str, float]


def linear_rotors(experiments: Sequence[Experiment], bound: BoundPlant) -> dict[str, Estimate]:
    """The manual's linear rotors, fitted to the records of experiments 1 and 2 where they are there."""
    return {
        entry.kind: linear_rotor(KINDS[entry.kind].run(entry, bound)) for entry in experiments if entry.kind in ROTORS
    }


def proof_facts(result: Identification, linear: Mapping[str, Estimate], proof: ProofReport) -> dict[str, Any]:
    """What the report shows beside the estimates, for a program."""
    rotors = {
        kind: {own.channel: asdict(own) for own in against_linear(result.stage_of(kind), estimate)}
        for kind, estimate in linear.items()
    }
    return {"against_linear": rotors, "flight_rms": dict(proof.flight_rms)}


def proven(result: Identification, truth: BoundPlant | None) -> ProofReport:
    """Searches side by side, and, where the truth is known, what it and the identified plant do."""
    evolution = evolution_plot(result.stages)
    sections = search_sections(result.stages, truth, evolution, (*result.estimates, *result.aids))
    pictures = {"6": evolution} if evolution else {}
    if truth is None:
        return ProofReport(sections, pictures, {})
    with console.stage("the real plant and the identified one"):
        if result.plant.model == "ce150_velagic":
            shown = responses(truth, bind(result.plant))
            plots = figure_plots(shown)
            return ProofReport([*sections, figure_section(shown, plots)], pictures | plots, {})
        if missing(truth) and not result.plant.design:
            return ProofReport(sections, pictures, {})  # no law is designed for such a plant
        try:
            flights = compare_flights(bind(result.plant), truth)
        except BadInput as error:  # what was identified is not lost with it
            return ProofReport([*sections, Section("Flight", (f"Not flown: {error}",))], pictures, {})
        return ProofReport([*sections, flight_section(flights)], pictures, flights.rms)
