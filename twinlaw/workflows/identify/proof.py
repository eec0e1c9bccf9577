"""What shows that an identification is right: searches side by side, and the real plant beside the identified one where it is known."""

from collections.abc import Mapping

from identification.experiments.velagic.figures import responses
from identification.proof.validation import compare_flights
from identification.results.result import Identification
from sim.bind import BoundPlant, bind
from twinlaw.cli import console
from twinlaw.pages.identify.report import flight_section
from twinlaw.pages.identify.search import evolution_plot, search_sections
from twinlaw.pages.identify.velagic import figure_plots, figure_section
from twinlaw.pages.page import Section


def proven(result: Identification, truth: BoundPlant | None) -> tuple[list[Section], Mapping[str, str]]:
    """Sections of the report, and pictures (SVG text) by the number of the paper's figure."""
    evolution = evolution_plot(result.stages)
    sections = search_sections(result.stages, truth, evolution, (*result.estimates, *result.aids))
    pictures = {"6": evolution} if evolution else {}
    if truth is None:
        return sections, pictures
    with console.stage("the real plant and the identified one"):
        if result.plant.model == "ce150_velagic":
            shown = responses(truth, bind(result.plant))
            plots = figure_plots(shown)
            return [*sections, figure_section(shown, plots)], pictures | plots
        return [*sections, flight_section(compare_flights(bind(result.plant), truth))], pictures
