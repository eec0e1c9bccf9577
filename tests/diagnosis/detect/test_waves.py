"""What swings as a sine: where a fit of it begins, and what the diagnosis calls it."""

import numpy as np
import pytest

from diagnosis.detect.instants import disturbed_by
from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.detect.waves import likely_waves, wave_starts
from diagnosis.diagnose import Material, diagnose
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from diagnosis.search.fitting import Proposal, rough
from records.log import RunLog
from sim.added_effects import library
from sim.bind import BoundPlant
from tests.diagnosis.conftest import LONG_S, Fly
from tests.diagnosis.nominal import nominal_fit
from tests.soak import sampled

# Truth: 9 and 14 waves a turn, 5 rad/s by the log's clock.
CYCLIC = {"phi_sensor.cyclic": {"amplitude": 0.003, "waves": 14.0, "phase": 0.7}}
DETENT = {"azimuth.detent": {"amplitude": 0.001, "waves": 9.0, "phase": -1.0}}
PERIODIC = {"elevation.periodic_torque": {"amplitude": 0.001, "rate": 5.0, "phase": 2.0}}


@pytest.mark.parametrize("truth", sampled([CYCLIC, DETENT, PERIODIC], keep=[CYCLIC]))
def test_a_sine_begins_near_its_waves(plant: BoundPlant, fly: Fly, truth) -> None:
    # A start must be within a sixth of a wave over the whole way, which is 1 rad, or 15 s to either side: 1 rad a rad, 0.07 rad/s.
    ((name, values),) = truth.items()
    case = make_case(effect_library(plant), [fly(61, truth, rig_seed=61)])
    starts = wave_starts(linearised(case, nominal_fit(case)), library(plant)[name])
    symbol, reach = ("rate", 0.07) if "rate" in values else ("waves", 1.0)
    assert min(abs(start[symbol] - values[symbol]) for start in starts) < reach


@pytest.mark.soak
def test_other_effects_begin_with_no_wave(plant: BoundPlant, fly: Fly) -> None:
    case = make_case(effect_library(plant), [fly(62)])
    assert wave_starts(linearised(case, nominal_fit(case)), library(plant)["azimuth.cable_spring"]) == []


@pytest.mark.soak
def test_no_sine_begins_at_what_the_motion_itself_repeats(plant: BoundPlant, fly: Fly) -> None:
    # A spring beside whose force the model swings wrongly wherever the arm swings, and nothing else: a sine in time would take its part.
    log = fly(62, {"elevation.cable_spring": {"k": 0.004, "h": 0.0, "angle_0": 0.3}}, LONG_S, rig_seed=61)
    linearisation = linearised(case := make_case(effect_library(plant), [log]), nominal_fit(case))
    effect = library(plant)["elevation.periodic_torque"]
    target = disturbed_by(case, effect)
    assert target is not None
    likely = [wave.number for wave in likely_waves(linearisation, target)]
    begun = {start["rate"] for start in wave_starts(linearisation, effect)}
    assert begun < set(likely)
    # Independent of the code: the share of the arm's speed, by differences, that a sine and a cosine of a frequency explain.
    assert min(swung(log, rate) for rate in set(likely) - begun) > 0.3 > max(swung(log, rate) for rate in begun)


def swung(log: RunLog, rate_rad_s: float) -> float:
    """The largest share of the elevation's speed that repeats with a frequency, or with a second to fifth of it."""
    speed = np.gradient(np.convolve(log.y[:, 0], np.ones(11) / 11, "valid"), 0.01)
    t_s = log.t_s[5:-5]
    shares = []
    for part in range(1, 6):
        wave = np.column_stack([np.sin(rate_rad_s / part * t_s), np.cos(rate_rad_s / part * t_s), np.ones(len(t_s))])
        left = speed - wave @ np.linalg.lstsq(wave, speed, rcond=None)[0]
        shares.append(1.0 - np.var(left) / np.var(speed))
    return float(max(shares))


@pytest.mark.soak
def test_a_sine_explains_more_than_a_springy_part(plant: BoundPlant, fly: Fly) -> None:
    # Both are fitted from where their score tests begin.
    case = make_case(effect_library(plant), [fly(63, PERIODIC, rig_seed=63)])
    nominal = nominal_fit(case)
    names = ("elevation.periodic_torque", "elevation.flexible_mode")
    tests = {entry.effect: entry for entry in score_effects(case, linearised(case, nominal), names)}
    sine, springy = (rough(case, Proposal(nominal, tests[name])) for name in names)
    assert sine is not None
    assert springy is None or sine.evidence > springy.evidence + 20.0
    found = sine.fit.hypothesis.effects[names[0]]
    assert found["rate"] == pytest.approx(5.0, rel=0.01)
    assert abs(found["amplitude"]) == pytest.approx(0.001, rel=0.15)


@pytest.mark.soak
@pytest.mark.parametrize("truth", [CYCLIC, PERIODIC])
def test_a_sine_is_no_springy_part(plant: BoundPlant, fly: Fly, truth) -> None:
    # Both were told as a flexible mode before the library had sines.
    ((name, values),) = truth.items()
    logs = [fly(seed, truth, rig_seed=63) for seed in (63, 64)]
    found = diagnose(plant, Material(logs[:1], logs[1:], ["hold"], [None, None])).diagnosis
    assert found.found == (name,)
    symbol = "rate" if "rate" in values else "waves"
    assert found.effects[0].parameters[symbol].value == pytest.approx(values[symbol], rel=0.01)
    size = found.effects[0].parameters["amplitude"].value
    assert abs(size) == pytest.approx(values["amplitude"], rel=0.1)
