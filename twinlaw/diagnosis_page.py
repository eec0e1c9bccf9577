"""The report of `twinlaw diagnose`: verdict, guilty block, shrinkage, maps, causes, what else it could be, and what to record next."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from records.diagnosis import Diagnosis, Hypothesis, Shrinkage
from sim.places import Places
from twinlaw.block_diagram import block_diagram
from twinlaw.page import Page, Section, Table
from twinlaw.plots import BLUE, GREEN, GREY, ORANGE, RED, SKY, Bars, Curve, Panel, bars, stack

Array = NDArray[np.float64]

# By the unit at the end of a name: how a person reads it.
_SHOWN = {
    "_rad": ("deg", 180.0 / math.pi),
    "_rad_s": ("deg/s", 180.0 / math.pi),
    "_m": ("mm", 1e3),
    "_m_s": ("mm/s", 1e3),
    "_V": ("V", 1.0),
}
_STAGES = (
    ("as stated", GREY, "nominal"),
    ("best re-tuned", ORANGE, "before"),
    ("with the effect", BLUE, "after"),
    ("noise floor", GREEN, "floor"),
)
_ZOOM_S = 8.0
ALWAYS, SELDOM = 3, 0.01  # the first few causes are always shown, further ones from this probability
LISTED = 3  # names in one cell
LEAST_CHANCE = 1e-6  # smaller ones are said to be below it: no model of noise is good for more


@dataclass(frozen=True)
class Predicted:
    """One hold-out log: true times, and by output the measured column and the predictions of the three plants, NaN where there is none."""

    name: str
    t_s: Array
    measured: Mapping[str, Array]
    nominal: Mapping[str, Array]
    before: Mapping[str, Array]
    after: Mapping[str, Array]


def diagnosis_page(
    plant: str,
    diagnosis: Diagnosis,
    places: Places,
    stories: Mapping[str, str],
    predicted: Sequence[Predicted],
    logs: Sequence[str],
) -> Page:
    """The whole page; `stories` gives one plain sentence for each effect, `logs` the names of the files that were diagnosed."""
    sections = [_place(diagnosis, places), _causes(diagnosis, stories)]
    if diagnosis.shrinkage is not None:
        sections.append(_shrinkage(diagnosis.shrinkage))
    sections += [_curves(log) for log in predicted]
    sections += [_maps(diagnosis), _firmware(diagnosis), _next(diagnosis), _notes(diagnosis)]
    return Page(
        title=f"{plant}: where the model and the rig part",
        verdict=verdict_sentence(diagnosis),
        passed=diagnosis.verdict == "no gap",
        facts=(("Logs", ", ".join(logs)),),
        sections=tuple(section for section in sections if section is not None),
    )


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """What was found, in one sentence for a reader who knows nothing but the rig."""
    if diagnosis.verdict == "no gap":
        return "The plant file explains these logs: nothing is missing that they could show."
    if diagnosis.verdict == "cannot tell":
        return "These logs hold too little motion to tell whether the plant file lacks anything."
    if not diagnosis.found:
        unknown = diagnosis.unknown
        where = f" in {_words(unknown.place)}" if unknown.place else ""
        return f"The rig does something{where} that the plant file lacks, and no effect of the library can be named for it."
    names = " and ".join(_words(name) for name in diagnosis.found)
    chance = next(
        (h.probability for h in diagnosis.effects if set(h.effect.split(" + ")) == set(diagnosis.found)), None
    )
    sure = "" if chance is None else f" ({_percent(chance)} sure)"
    shrunk = diagnosis.shrinkage.fraction if diagnosis.shrinkage else None
    gain = (
        ""
        if shrunk is None
        else f" With it in the model, {_percent(shrunk)} of the removable error on the hold-out logs is gone."
    )
    return f"The rig has what the plant file lacks: {names}{sure}.{gain}"


def _place(diagnosis: Diagnosis, places: Places) -> Section:
    shares = {entry.place: entry.share for entry in diagnosis.places}
    p = diagnosis.false_alarm_probability
    chance = (
        ""
        if p is None
        else f"A rig that is as the plant file states, with its sensors, shows so large a gap with probability {_chance(p)}."
    )
    return Section(
        "Where it lies",
        tuple(filter(None, (chance, "The warmer a block, the more of the gap lies there." if shares else ""))),
        plots=(block_diagram(places, shares),),
    )


def _causes(diagnosis: Diagnosis, stories: Mapping[str, str]) -> Section | None:
    if not diagnosis.effects and not diagnosis.unknown.probability:
        return None
    told = [f"{_words(name).capitalize()}: {stories[name]}" for name in diagnosis.found if name in stories]
    told += [
        f"These data cannot tell {_words(h.effect)} from {_listed([_words(name) for name in h.ambiguous_with])}."
        for h in diagnosis.effects[:1]
        if h.ambiguous_with and diagnosis.found
    ]
    rows = [
        _cause_row(h, set(h.effect.split(" + ")) == set(diagnosis.found))
        for place, h in enumerate(diagnosis.effects)
        if place < ALWAYS or h.probability > SELDOM
    ]
    unknown = diagnosis.unknown
    rows.append(("none of the library", unknown.class_ or "", _percent(unknown.probability), "", ""))
    return Section(
        "What causes it",
        told,
        (Table(rows, ("effect", "depends on, acts on", "probability", "size", "looks the same")),),
    )


def _cause_row(hypothesis: Hypothesis, found: bool) -> tuple[str, ...]:
    size = ", ".join(
        f"{name} = {e.value:.4g} ± {e.sd:.1g} {e.unit}".strip() for name, e in hypothesis.parameters.items()
    )
    name = hypothesis.effect + (" (found)" if found else "")
    return name, hypothesis.class_, _percent(hypothesis.probability), size, _listed(hypothesis.ambiguous_with)


def _shrinkage(shrinkage: Shrinkage) -> Section:
    panels, rows = [], []
    for output in shrinkage.rms_nominal:
        name, unit, scale = _shown(output)
        heights = [scale * getattr(shrinkage, f"rms_{key}")[output] for _, _, key in _STAGES]
        panels.append(
            Bars(
                heights,
                [label.replace(" ", "\n", 1) for label, _, _ in _STAGES],
                f"rms error of {name} {unit}",
                colours=[c for _, c, _ in _STAGES],
            )
        )
        rows.append((f"{name} {unit}", *(f"{height:.4g}" for height in heights)))
    sentences = [
        "Errors of free-running predictions over windows of 1 s on logs that were not used to find the effect."
    ]
    if shrinkage.fraction is not None:
        interval = shrinkage.fraction_ci95
        within = "" if interval is None else f", 95 % interval {_percent(interval[0])} to {_percent(interval[1])}"
        sentences.append(
            f"Of what a perfect model could remove beyond re-tuning, {_percent(shrinkage.fraction)} is removed{within}."
        )
    return Section(
        "How far the gap shrinks",
        sentences,
        (Table(rows, ("output", *(label for label, _, _ in _STAGES))),),
        (bars(panels, height_in=2.8),),
    )


def _curves(log: Predicted) -> Section:
    span = _worst_span(log)
    panels = []
    for output, measured in log.measured.items():
        name, unit, scale = _shown(output)
        lines = (
            ("measured", measured, GREY, "-"),
            ("as stated", log.nominal[output], RED, ":"),
            ("best re-tuned", log.before[output], ORANGE, "--"),
            ("improved", log.after[output], BLUE, "-"),
        )
        panels.append(
            Panel(
                f"{name} {unit}",
                [Curve(log.t_s[span], scale * y[span], label, colour, dash) for label, y, colour, dash in lines],
            )
        )
    return Section(
        f"Predicted and measured: {log.name}",
        (
            f"The {_ZOOM_S:g} s in which the stated plant errs most.",
            "Each curve starts afresh every second from what was measured until then.",
        ),
        plots=(stack(panels, "time [s]"),),
    )


def _worst_span(log: Predicted) -> NDArray[np.bool_]:
    """Rows of the window of `_ZOOM_S` in which the stated plant errs most, outputs weighed by their spread."""
    error = np.zeros(len(log.t_s))
    for output, measured in log.measured.items():
        spread = float(np.std(measured[np.isfinite(measured)])) if np.isfinite(measured).any() else 0.0
        error += np.nan_to_num((log.nominal[output] - measured) / (spread or 1.0)) ** 2
    ends = np.searchsorted(log.t_s, log.t_s + _ZOOM_S)
    total = np.concatenate([[0.0], np.cumsum(error)])
    start = int(np.argmax(total[ends] - total[:-1]))
    rows = np.zeros(len(log.t_s), dtype=bool)
    rows[start : ends[start]] = True
    return rows


def _maps(diagnosis: Diagnosis) -> Section | None:
    panels = []
    if diagnosis.when:
        panels.append(
            Bars(
                [100 * s.share for s in diagnosis.when],
                [(s.start_s, s.end_s) for s in diagnosis.when],
                "share [%]",
                "time [s]",
                (BLUE,),
            )
        )
    for signal in dict.fromkeys(region.signal for region in diagnosis.regions):
        name, unit, scale = _shown(signal)
        chosen = [region for region in diagnosis.regions if region.signal == signal]
        panels.append(
            Bars(
                [100 * r.share for r in chosen],
                [(scale * r.from_, scale * r.to) for r in chosen],
                "share [%]",
                f"{name} {unit}",
                (ORANGE,),
            )
        )
    if diagnosis.bands:
        panels.append(
            Bars(
                [100 * b.share for b in diagnosis.bands],
                [(max(b.from_Hz, 1e-2), b.to_Hz) for b in diagnosis.bands],
                "share [%]",
                "frequency [Hz]",
                (SKY,),
                True,
            )
        )
    if not panels:
        return None
    rows = [panels[i : i + 3] for i in range(0, len(panels), 3)]
    return Section(
        "When, in which region and at which frequencies",
        ("How the gap spreads; the taller a bar, the more of it lies there.",),
        plots=[bars(r) for r in rows],
    )


def _firmware(diagnosis: Diagnosis) -> Section | None:
    firmware = diagnosis.firmware
    if firmware is None:
        return None
    again = "Run again on the logged measurements, the controller's own code"
    if not firmware.replayed:
        sentence = (
            f"The controller's code could not be run again on the logs: {firmware.cause or 'its table is not at hand'}."
        )
    elif firmware.bit_exact:
        sentence = f"{again} gives every logged input to the bit: the firmware is cleared."
    else:
        cause = firmware.cause or "cause not found"
        sentence = f"{again} first differs at {firmware.first_difference_s:g} s: {cause}."
    return Section("Firmware", (sentence,))


def _next(diagnosis: Diagnosis) -> Section | None:
    if not diagnosis.next_experiment:
        return None
    rows = [(name.replace("_", " "), _text(value)) for name, value in diagnosis.next_experiment.items()]
    return Section("What to record next", (), (Table(rows),))


def _notes(diagnosis: Diagnosis) -> Section | None:
    return Section("Notes", diagnosis.notes) if diagnosis.notes else None


def _text(value: object) -> str:
    if isinstance(value, Mapping):
        return "; ".join(f"{name}: {_text(entry)}" for name, entry in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(_text(entry) for entry in value)
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _words(name: str) -> str:
    """ "azimuth.cable_spring" as "cable spring of the azimuth", several with "and"."""
    parts = [part.replace("_", " ").partition(".") for part in name.split(" + ")]
    return " and ".join(f"{effect} of the {place}" if effect else f"the {place}" for place, _, effect in parts)


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
    return "; ".join(names[:LISTED]) + more


def _chance(p: float) -> str:
    return f"{p:.2g}" if p >= LEAST_CHANCE else f"below {LEAST_CHANCE:g}"


def _percent(share: float) -> str:
    if 0.9995 < share < 1.0:
        return "> 99.9 %"
    return f"{100 * share:.1f} %" if share >= 0.001 or share == 0.0 else "< 0.1 %"


def _shown(name: str) -> tuple[str, str, float]:
    """Name without its unit, the unit a person reads, and the factor to it."""
    for suffix, (unit, scale) in _SHOWN.items():
        if name.endswith(suffix):
            return name.removesuffix(suffix), f"[{unit}]", scale
    return name, "", 1.0
