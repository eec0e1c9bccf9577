"""The figures of seed 002 redrawn: 2 a sweep, 3 the transfer to the centre of gravity, 5 frequency responses, 6 verification in time."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from identification import thresholds
from identification.frequency.models.lateral_record import LateralFlight
from identification.frequency.result import FrequencyIdentification, TimeCheck
from identification.frequency.truth import Truth
from records.text.units import label
from twinlaw.pages.plots import BLACK, BLUE, GREEN, GREY, ORANGE, RED, SKY, Curve, Panel, grid, stack

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def pictures(
    found: FrequencyIdentification, truth: Truth | None = None, flown: LateralFlight | None = None
) -> Mapping[str, str]:
    """Figs. 5 and 6 of seed 002 as SVG texts by name, and Figs. 2 and 3 of the flight that was `flown`."""
    outputs = enumerate(found.fit.model.outputs)
    responses = {response_name(name): _bode(found, truth, o) for o, name in outputs}
    swept = {} if flown is None else {SWEEP: sweep_plot(flown), TRANSFER: transfer_plot(flown)}
    return swept | responses | {check_name(check): _history(found, check) for check in found.checks}


SWEEP, TRANSFER = "fig-2", "fig-3"


def response_name(output: str) -> str:
    """The name of an output's picture."""
    return f"fig-5-{output}"


def check_name(check: TimeCheck) -> str:
    """The name of a record's picture."""
    return f"fig-6-{check.name}"


def sweep_plot(flown: LateralFlight) -> str:
    """Fig. 2: the sweep of a stick, the other one beside it, and the roll rate that answers."""
    sticks = [
        Curve(flown.t_s, flown.u[:, place], name, colour, width=0.8)
        for place, (name, colour) in enumerate((("lateral", BLUE), ("pedals", ORANGE)))
    ]
    rate = Curve(flown.t_s, np.degrees(flown.p_rad_s), "", GREY, width=0.8)
    return stack((Panel("stick [its own unit]", sticks), Panel("roll rate p [deg/s]", (rate,))), "time [s]")


def transfer_plot(flown: LateralFlight) -> str:
    """Fig. 3: the lateral acceleration as read and at the centre of gravity, and the two parts that were taken off."""
    moved = flown.transferred
    acceleration = (
        Curve(flown.t_s, flown.a_y_m_s2, "where the sensor stands", GREY, width=0.8),
        Curve(flown.t_s, moved.a_cg_m_s2[:, 1], "at the centre of gravity", BLUE, width=0.8),
    )
    parts = (
        Curve(flown.t_s, moved.turning_m_s2[:, 1], "omega' x r", BLUE, width=0.8),
        Curve(flown.t_s, moved.centripetal_m_s2[:, 1], "omega x (omega x r)", RED, width=0.8),
    )
    return stack((Panel("a_y [m/s^2]", acceleration), Panel("taken off [m/s^2]", parts)), "time [s]")


def _bode(found: FrequencyIdentification, truth: Truth | None, o: int) -> str:
    """Magnitude, phase and coherence of one output, a column for each input."""
    inputs = range(len(found.fit.model.inputs))
    lines = [[panel(found, truth, o, i) for i in inputs] for panel in (_gain, _phase, _coherence)]
    titles = [f"{label(name)} to {label(found.fit.model.outputs[o])}" for name in found.fit.model.inputs]
    return grid(lines, titles, "frequency [rad/s]", log_x=True)


def _gain(found: FrequencyIdentification, truth: Truth | None, o: int, i: int) -> Panel:
    return Panel("magnitude [dB]", _curves(found, truth, o, i, lambda T: 20.0 * np.log10(np.abs(T))))


def _phase(found: FrequencyIdentification, truth: Truth | None, o: int, i: int) -> Panel:
    """Unwrapped along the model; what is measured goes to the turn next to it."""
    model = np.unwrap(np.angle(found.T[:, o, i]))

    def shown(T: Complex) -> Array:
        beside: Array = np.angle(T / found.T[:, o, i])
        return np.degrees(model + beside)

    return Panel("phase [deg]", _curves(found, truth, o, i, shown))


def _curves(
    found: FrequencyIdentification, truth: Truth | None, o: int, i: int, shown: Callable[[Complex], Array]
) -> tuple[Curve, ...]:
    fit, omega = found.fit, found.fit.responses.omega_rad_s
    corrected = shown(fit.responses.T[:, o, i])
    k = fit.points.frequency[(fit.points.output == o) & (fit.points.input == i)]
    return (
        Curve(omega, shown(fit.T_raw[:, o, i]), "measured", GREY),
        Curve(omega[k], corrected[k], "matched, error of finite windows taken off", BLUE, "", "o"),
        Curve(omega, shown(found.T[:, o, i]), "identified model", ORANGE, "--"),
        Curve(omega, shown(found.T_stated[:, o, i]), "plant file", GREEN, ":"),
        *([] if truth is None else [Curve(omega, shown(truth.T[:, o, i]), "truth", BLACK, "-.")]),
    )


def _coherence(found: FrequencyIdentification, truth: Truth | None, o: int, i: int) -> Panel:
    responses = found.fit.responses
    curve = Curve(responses.omega_rad_s, responses.coherence[:, o, i], "", GREY)
    return Panel("coherence [-]", (curve,), ((thresholds.GOOD_COHERENCE, ""),), within=(0.0, 1.02))


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
