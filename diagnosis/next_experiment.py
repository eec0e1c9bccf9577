"""What to record next: of the rig's own menu, the run that best separates the hypotheses that are still alike."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from diagnosis.weigh import Weighed

LEAST = 0.02  # of probability that must be at stake


@dataclass(frozen=True)
class Experiment:
    """One run of the menu: what to do, and the groups of effect kinds that look different in it; kinds of one group stay alike."""

    name: str
    instruction: str
    reason: str
    groups: tuple[frozenset[str], ...]


def _group(text: str) -> frozenset[str]:
    return frozenset(text.split())


MENU: Sequence[Experiment] = (
    Experiment(
        "rotor speeds logged",
        "repeat the run with both rotor speeds in the log",
        "what acts before the rotor shows in its speed, what acts behind it does not",
        (
            _group(
                "input.lag input.delay input.slew_limit input.deadzone input.saturation input.supply_sag input.gain"
            ),
            _group("rotor.downwash rotor.ground_effect rotor.axial_inflow rotor.reverse_asymmetry"),
            _group("sensor.delay sensor.lag loop.delay"),
            _group("rotor.dry_friction rotor.warmup"),
        ),
    ),
    Experiment(
        "wide azimuth sweep",
        "sweep the azimuth slowly over its whole range, elevation held",
        "a spring grows with the angle, tilt and wind repeat with it, hysteresis depends on where it came from",
        (_group("cable_spring"), _group("tilt wind"), _group("cable_hysteresis"), _group("friction_asymmetry")),
    ),
    Experiment(
        "rig turned by 90 degrees",
        "mount the rig turned by 90 degrees and repeat the run: gravity no longer acts on the elevation",
        "what gravity does vanishes, stiffness and encoder offset stay",
        (
            _group("centre_of_gravity balance_weight weight_shift"),
            _group("cable_spring"),
            _group("offset ground_effect"),
        ),
    ),
    Experiment(
        "coast-down",
        "switch the motors off at speed and let each axis come to rest, from both directions",
        "friction that depends on load vanishes with the rotors at rest; drag and dry friction slow down differently",
        (
            _group("stribeck coulomb presliding"),
            _group("load_friction axial_inflow"),
            _group("quadratic_drag"),
            _group("friction_asymmetry"),
        ),
    ),
    Experiment(
        "dither",
        "add a pseudo-random dither of a tenth of the range, 0.3 Hz to 6 Hz, to both inputs",
        "a lag bends the phase, a delay turns it, a slew limit depends on the size of the step",
        (
            _group("lag"),
            _group("delay dropped_frames"),
            _group("slew_limit"),
            _group("flexible_mode rotor_acceleration"),
        ),
    ),
    Experiment(
        "slow ramp",
        "ramp each reference slowly up and down without dither",
        "steps of inputs and sensors and play show at reversals and between counts",
        (_group("quantization"), _group("backlash"), _group("deadzone"), _group("stribeck presliding coulomb")),
    ),
)


def next_experiment(weighed: Weighed) -> Mapping[str, Any] | None:
    """The run that separates most of what is undecided, with the outcome to expect; None where nothing is."""
    pairs = [
        (one, other, weighed.probabilities[one] * weighed.probabilities[other])
        for one, other in combinations(range(len(weighed.tried)), 2)
    ]
    if sum(stake for *_, stake in pairs) < LEAST:
        return None
    best, worth, split = None, 0.0, list[str]()
    for experiment in MENU:
        found = [(a, b, stake) for a, b, stake in pairs if _separates(experiment, weighed, a, b)]
        gain = sum(stake for *_, stake in found)
        if gain > worth:
            best, worth = experiment, gain
            split = [f"{_text(weighed, a)} from {_text(weighed, b)}" for a, b, _ in found[:3]]
    if best is None:
        return None
    return {
        "experiment": best.name,
        "instruction": best.instruction,
        "separates": split,
        "expected_outcome": best.reason,
    }


def _text(weighed: Weighed, index: int) -> str:
    return " + ".join(weighed.tried[index].effects)


def _separates(experiment: Experiment, weighed: Weighed, one: int, other: int) -> bool:
    first, second = set(weighed.tried[one].effects), set(weighed.tried[other].effects)
    groups = [{_place(experiment, name) for name in names} - {None} for names in (first - second, second - first)]
    return bool(groups[0]) and bool(groups[1]) and groups[0] != groups[1]


def _place(experiment: Experiment, effect: str) -> int | None:
    """The group that an effect belongs to."""
    place, kind = effect.split(".")
    side = place.rsplit("_", 1)[-1]
    for index, group in enumerate(experiment.groups):
        if kind in group or f"{side}.{kind}" in group:
            return index
    return None
