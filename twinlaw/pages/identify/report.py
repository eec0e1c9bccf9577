"""The report of `twinlaw identify`: estimates and what cannot be told, the fits, Figs. 7, 8, 10 and 13 of the paper redrawn."""

from collections.abc import Mapping, Sequence

import numpy as np

from identification.proof.linear_rotor import against_linear, readings_by
from identification.proof.validation import Comparison
from identification.results.quality import identification_quality
from identification.results.result import Identification
from identification.stages.estimate import Estimate
from records.experiment import Experiment
from records.text.uncertain import to_sd
from records.text.units import shown, stem
from sim.columns import reference_name
from twinlaw.pages.identify.residuals import fit_section
from twinlaw.pages.identify.summary import (
    AID_HEADING,
    FIT_HEADING,
    SCALE,
    aid_rows,
    estimate_heading,
    estimate_rows,
    fit_rows,
    held_out_rows,
    remarked,
)
from twinlaw.pages.measured import measured
from twinlaw.pages.page import Page, Section, Table, as_sentence
from twinlaw.pages.plots import BLUE, GREEN, GREY, ORANGE, RED, Curve, Panel, row, stack
from twinlaw.pages.quality import quality_section, quality_sentence

ROTORS = {"main_rotor": ("main rotor", "Fig. 7"), "tail_rotor": ("tail rotor", "Fig. 8")}
SHOWN_S = 15.0


def identify_page(
    result: Identification,
    experiments: tuple[Experiment, ...],
    linear: Mapping[str, Estimate],
    further: Sequence[Section] = (),
    truth: Mapping[str, float] | None = None,
) -> Page:
    """The whole page; `linear` are the manual's rotors by experiment, `further` sections come last, and the `truth` stands beside the
    estimates where it is known.
    """
    told = sum(entry.identified for entry in result.estimates)
    quality = identification_quality(result, truth or {})
    sections = [_estimates(result, truth), *_correlation(result), *_fits(result)]
    by_kind = {experiment.kind: experiment for experiment in experiments}
    sections += [_rotor(kind, result, estimate) for kind, estimate in linear.items()]
    if "gravity" in by_kind:
        sections.append(_gravity(by_kind["gravity"], result))
    sections += [fit_section(data.title, stage) for data, stage in result.stages]
    return Page(
        title=f"{result.plant.name}: identified",
        verdict=(
            f"{result.warning}. " * bool(result.warning)
            + f"{told} of {len(result.estimates)} parameters identified; {remarked(len(result.notes))}."
        ),
        colour=quality.colour,
        why=quality_sentence(quality),
        facts=(("Equations", result.plant.model),),
        sections=(*sections, *further, quality_section(quality)),
    )


def _estimates(result: Identification, truth: Mapping[str, float] | None) -> Section:
    tables = [Table(estimate_rows(result.estimates, result.at_bound, truth), estimate_heading(truth))]
    if result.aids:
        tables.append(Table(aid_rows(result.aids), AID_HEADING))
    return Section("Parameters", (*map(as_sentence, result.notes or ("Nothing to remark.",)), SCALE), tuple(tables))


def _correlation(result: Identification) -> list[Section]:
    """The pairs that hang together most; the whole matrix is in plant.toml."""
    matrix, names = result.belief.correlation, result.belief.names
    pairs = [(abs(matrix[i, j]), names[i], names[j], matrix[i, j]) for i in range(len(names)) for j in range(i)]
    rows = [(a, b, f"{value:+.3f}") for _, a, b, value in sorted(pairs, key=lambda pair: -pair[0])[:12]]
    sentence = "Pairs whose errors hang together most: only a combination of such two is known well. The whole matrix is in plant.toml."
    return (
        [Section("Correlation", (sentence,), (Table(rows, ("parameter", "parameter", "correlation")),))] if rows else []
    )


def _fits(result: Identification) -> list[Section]:
    """Every channel that has readings enough to be judged."""
    sentence = (
        "The rms of what is left, beside what the sensor's rounding and noise alone leave; fit = 1 - |y - prediction| / |y - mean|. "
        "Readings that are more correlated than their rounding explains count for fewer samples in the intervals."
    )
    rows = [*fit_rows(result.stages), *held_out_rows(result.holdout)]
    return [Section("Fits", (sentence,), (Table(rows, FIT_HEADING),))] if rows else []


def _rotor(kind: str, result: Identification, linear: Estimate) -> Section:
    """Speed and thrust over time: measured, polynomial model, the manual's linear one."""
    name, figure = ROTORS[kind]
    stage = result.stage_of(kind)
    panels = [_rotor_panel(stage, linear, number, label) for number, label in ((0, "speed [rad/s]"), (1, "thrust [N]"))]
    rows = [
        (own.channel, f"{own.fit_percent:.2f} %", f"{own.linear_fit_percent:.2f} %", f"{own.rms_ratio:.1f}")
        for own in against_linear(stage, linear)
    ]
    heading = ("channel", "polynomial fit", "linear fit", "linear rms / polynomial rms")
    return Section(
        f"{name.capitalize()} ({figure})",
        (
            "The model with polynomial friction and thrust beside the manual's linear one, both fitted to the whole record.",
        ),
        (Table(rows, heading),),
        (stack(panels, "time [s]"),),
    )


def _rotor_panel(stage: Estimate, linear: Estimate, number: int, label: str) -> Panel:
    run = stage.runs[0]
    mine = (run.channel == number) & (run.at_s < SHOWN_S)
    t_s = run.at_s[mine]
    return Panel(
        label,
        (
            Curve(t_s, run.y[mine], "measured", GREY, "", "o"),
            Curve(t_s, readings_by(linear)[mine], "linear", ORANGE, "--"),
            Curve(t_s, readings_by(stage)[mine], "polynomial", BLUE),
        ),
    )


def _gravity(experiment: Experiment, result: Identification) -> Section:
    """Rest angles over weights and the curve of eq (11)."""
    found, facts = experiment.streams["balance"], {entry.name: entry.value for entry in result.aids}
    tau = next(entry for entry in result.estimates if entry.name == "tau_gE")
    psi = np.linspace(float(found["psi_rad"].min()), float(found["psi_rad"].max()), 100)
    g = result.plant.parameters["g"].values[0]
    weight = tau.value * np.cos(psi + facts["Psi_m"]) / (facts["lever"] * g * np.cos(psi + facts["lever_angle"]))
    panel = Panel(
        "elevation [deg]",
        (
            Curve(
                1e3 * found["weight_kg"], np.degrees(found["psi_rad"]), "at rest, from above and below", BLUE, "", "o"
            ),
            Curve(1e3 * weight, np.degrees(psi), f"tau_gE = {to_sd(tau.value, tau.sd)} N m", ORANGE),
        ),
    )
    sentence = "Weights at the tail and the angles at which the arm rests; dry friction lets it rest to either side of its balance."
    return Section("Gravity torque (Fig. 10)", (sentence,), (), (row((panel,), ("weight [g]",)),))


def flight_section(comparison: Comparison) -> Section:
    """Both flights over one another."""
    real, here = comparison.real, comparison.identified
    panels = []
    for name in (*real.columns.outputs, *real.columns.inputs):
        (unit, scale), wanted = shown(name), reference_name(name)
        curves = [
            *([Curve(real.t_s, scale * real.column(wanted), "reference", GREY, ":")] if wanted in real.extra else []),
            Curve(real.t_s, scale * real.column(name), "real plant", GREEN),
            Curve(here.t_s, scale * here.column(name), "identified", RED, "--"),
        ]
        panels.append(Panel(f"{stem(name)} [{unit}]", tuple(curves)))
    rows = [(name, measured(value, name)) for name, value in comparison.rms.items()]
    return Section(
        "Validation in the control structure",
        ("One controller, designed from the identified plant, flies the real plant and the identified one.",),
        (Table(rows, ("column", "rms difference")),),
        (stack(panels, "time [s]"),),
    )
