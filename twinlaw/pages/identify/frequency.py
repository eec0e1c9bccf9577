"""The report of `twinlaw identify --method frequency`: matrices, pairs, Figs. 5 and 6 of seed 002 redrawn; its tables as rows of text."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from identification.frequency.models.elements import StateSpaces, state_space_with_sd
from identification.frequency.result import FrequencyIdentification, Pair, TimeCheck
from records.text.units import label
from twinlaw.pages.identify.summary import HEADING, estimate_rows
from twinlaw.pages.page import Page, Section, Table
from twinlaw.pages.plots import BLUE, GREEN, GREY, ORANGE, SKY, Curve, Panel, grid

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
PAIR_HEADING = ("input", "output", "matched from", "to", "coherence", "J", "model off by", "plant file off by")
ROUNDING = 1e-9
CHECK_HEADING = ("record", "output", "rms", "fit", "fit of the plant file")


def pair_rows(pairs: Sequence[Pair]) -> list[tuple[str, ...]]:
    """One row for each input and output."""
    return [
        (pair.input, pair.output, "-", "-", f"{pair.coherence:.2f} at most", "-", "-", "-")
        if not pair.points
        else (
            pair.input,
            pair.output,
            f"{pair.from_rad_s:.3g} rad/s",
            f"{pair.to_rad_s:.3g} rad/s",
            f"{pair.coherence:.3f}",
            f"{pair.J:.1f}",
            f"{pair.left_dB:.2f} dB, {pair.left_deg:.1f} deg",
            f"{pair.stated_dB:.2f} dB, {pair.stated_deg:.1f} deg",
        )
        for pair in pairs
    ]


def check_rows(checks: Sequence[TimeCheck], outputs: Sequence[str]) -> list[tuple[str, ...]]:
    """One row for each output of each record that was not matched."""
    return [
        (check.name, output, f"{rms:.3g}", f"{100.0 * fit:.1f} %", f"{100.0 * stated:.1f} %")
        for check in checks
        for output, rms, fit, stated in zip(outputs, check.rms, check.fit, check.stated_fit, strict=True)
    ]


def frequency_page(found: FrequencyIdentification, plots: Mapping[str, str]) -> Page:
    """The whole page, with its `pictures`."""
    estimates = found.result.estimates
    told = sum(entry.identified for entry in estimates)
    sections = [
        _parameters(found),
        _matrices(found),
        _responses(found, plots),
        *(_check(found, check, plots) for check in found.checks),
    ]
    return Page(
        title=f"{found.result.plant.name}: identified in the frequency domain",
        verdict=f"{told} of {len(estimates)} parameters identified; J = {found.fit.J:.1f}; {len(found.notes)} remarks.",
        passed=told == len(estimates),
        facts=(("Equations", found.result.plant.model),),
        sections=tuple(sections),
    )


def pictures(found: FrequencyIdentification) -> Mapping[str, str]:
    """Figs. 5 and 6 of seed 002 as SVG texts by name: the responses of each output, each record checked on."""
    outputs = enumerate(found.fit.model.outputs)
    responses = {_response_name(name): _bode(found, o) for o, name in outputs}
    return responses | {_check_name(check): _history(found, check) for check in found.checks}


def _response_name(output: str) -> str:
    return f"fig-5-{output}"


def _check_name(check: TimeCheck) -> str:
    return f"fig-6-{check.name}"


def _parameters(found: FrequencyIdentification) -> Section:
    return Section(
        "Parameters", found.notes or ("Nothing to remark.",), (Table(estimate_rows(found.result.estimates), HEADING),)
    )


def _matrices(found: FrequencyIdentification) -> Section:
    """A and B with what they may be off by."""
    of = state_space_with_sd(found.fit.model, found.fit.theta, found.fit.covariance)
    sentence = "x' = A x + B u about the trim; each element with its 95 % interval, none where it is known."
    return Section("The identified A and B, eq (8)", (sentence,), tuple(Table(_matrix_rows(of, name)) for name in "AB"))


def _matrix_rows(of: StateSpaces, name: str) -> list[tuple[str, ...]]:
    values, sds = getattr(of.value, name), getattr(of.sd, name)
    least = ROUNDING * float(np.max(sds))
    return [
        (
            name,
            *(
                f"{value:.4g}" + (f" ± {1.96 * sd:.2g}" if sd > least else "")
                for value, sd in zip(line, own, strict=True)
            ),
        )
        for line, own in zip(values, sds, strict=True)
    ]


def _responses(found: FrequencyIdentification, plots: Mapping[str, str]) -> Section:
    fit = found.fit
    sentences = (
        "Conditioned frequency responses from windows of "
        + ", ".join(f"{entry.length_s:.3g}" for entry in fit.responses.windows)
        + " s; points are those that were matched. A dotted line is the plant file as it was.",
        f"Secant searches from {len(fit.searches)} starts ended at J = "
        + ", ".join(f"{entry.J:.4g}" for entry in fit.searches)
        + f", before finite windows were corrected for; with that J = {fit.J:.4g}.",
    )
    shown = tuple(plots[_response_name(name)] for name in fit.model.outputs)
    return Section("Frequency responses (Fig. 5)", sentences, (Table(pair_rows(found.pairs), PAIR_HEADING),), shown)


def _bode(found: FrequencyIdentification, o: int) -> str:
    """Magnitude, phase and coherence of one output, a column for each input."""
    inputs = range(len(found.fit.model.inputs))
    lines = [[panel(found, o, i) for i in inputs] for panel in (_gain, _phase, _coherence)]
    titles = [f"{name} to {found.fit.model.outputs[o]}" for name in found.fit.model.inputs]
    return grid(lines, titles, "frequency [rad/s]", log_x=True)


def _gain(found: FrequencyIdentification, o: int, i: int) -> Panel:
    return Panel("magnitude [dB]", _curves(found, o, i, lambda T: 20.0 * np.log10(np.abs(T))))


def _phase(found: FrequencyIdentification, o: int, i: int) -> Panel:
    """Unwrapped along the model; what is measured goes to the turn next to it."""
    model = np.unwrap(np.angle(found.fit.T[:, o, i]))

    def shown(T: Complex) -> Array:
        beside: Array = np.angle(T / found.fit.T[:, o, i])
        return np.degrees(model + beside)

    return Panel("phase [deg]", _curves(found, o, i, shown))


def _curves(found: FrequencyIdentification, o: int, i: int, shown: Callable[[Complex], Array]) -> tuple[Curve, ...]:
    fit, omega = found.fit, found.fit.responses.omega_rad_s
    corrected = shown(fit.responses.T[:, o, i])
    k = fit.points.frequency[(fit.points.output == o) & (fit.points.input == i)]
    return (
        Curve(omega, shown(fit.T_raw[:, o, i]), "measured", GREY),
        Curve(omega[k], corrected[k], "matched, error of finite windows taken off", BLUE, "", "o"),
        Curve(omega, shown(fit.T[:, o, i]), "identified model", ORANGE, "--"),
        Curve(omega, shown(found.T_stated[:, o, i]), "plant file", GREEN, ":"),
    )


def _coherence(found: FrequencyIdentification, o: int, i: int) -> Panel:
    responses = found.fit.responses
    return Panel("coherence", (Curve(responses.omega_rad_s, responses.coherence[:, o, i], "", GREY),), ((0.6, ""),))


def _check(found: FrequencyIdentification, check: TimeCheck, plots: Mapping[str, str]) -> Section:
    """How a record that was not matched is predicted."""
    anew = "" if np.isinf(check.window_s) else f" It starts anew every {check.window_s:g} s, as the loop was closed."
    sentence = f"A record that was not matched: the identified model under its inputs; start and trim are fitted, nothing else.{anew}"
    return Section(
        f"Verification in time: {check.name} (Fig. 6)",
        (sentence,),
        (Table(check_rows((check,), found.fit.model.outputs), CHECK_HEADING),),
        (plots[_check_name(check)],),
    )


def _history(found: FrequencyIdentification, check: TimeCheck) -> str:
    """Inputs above, outputs below, measured and predicted."""
    model = found.fit.model
    lines = [
        [Panel(label(name), (Curve(check.t_s, check.u[:, i], "input", SKY),))] for i, name in enumerate(model.inputs)
    ]
    for o, name in enumerate(model.outputs):
        measured = Curve(check.t_s, check.y[:, o], "measured", GREY)
        lines.append(
            [Panel(label(name), (measured, Curve(check.t_s, check.y_model[:, o], "identified model", ORANGE, "--")))]
        )
    return grid(lines, [""], "time [s]", height_in=1.3)
