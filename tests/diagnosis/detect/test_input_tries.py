"""Effects on an input's way to first order: what a pass would gain, which of them are worth one."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from diagnosis.detect.full_size import along
from diagnosis.detect.input_steps import turns
from diagnosis.detect.input_tries import Promise, promises
from diagnosis.detect.linearisation import Linearisation, linearised
from diagnosis.hypothesis.case import make_case
from diagnosis.library.effect_library import effect_library
from records.log import RunLog
from records.plant import load_plant
from sim.added_effects import library
from sim.bind import bind
from sim.columns import log_columns
from sim.effect import Effect, Values
from sim.simulate import Conditions, simulate
from tests.diagnosis.arm import LONG_S, arm, arm_case, arm_log, plain_linearisation
from tests.diagnosis.nominal import nominal_fit
from tests.own_plants import PLAIN, OwnPlant


def tries(name: str, sizes: Sequence[float]) -> list[tuple[Effect, Values]]:
    effect = library(arm())[name]
    return [(effect, {**effect.absent, effect.size.symbol: size}) for size in sizes]


def seen_in(*logs: RunLog) -> Linearisation:
    case = arm_case(*logs)
    return linearised(case, nominal_fit(case))


def promised(linearisation: Linearisation, asked: Sequence[tuple[Effect, Values]]) -> list[Promise]:
    found = promises(linearisation, asked)
    assert all(entry is not None for entry in found)
    return [entry for entry in found if entry is not None]


@pytest.mark.parametrize(
    ("name", "sizes"),
    [("input.slew_limit", (1.0, 0.5)), ("input.saturation", (2.2, 2.0, 1.9)), ("input.lag", (0.02, 0.1))],
)
def test_first_order_promises_what_a_pass_gains(name: str, sizes: Sequence[float]) -> None:
    # Truth: the pass itself. The arm's sine is bent by what moves it, and thrust by the command: a tenth of what changes, and a nat.
    linearisation = plain_linearisation()
    asked = tries(name, sizes)
    for promise, (effect, values) in zip(promised(linearisation, asked), asked, strict=True):
        (tried,) = along(linearisation.case, linearisation, effect, [values])
        assert promise.power == pytest.approx(tried.power, rel=0.1)
        assert promise.absorbed == pytest.approx(tried.absorbed, abs=0.1)
        assert promise.gain == pytest.approx(tried.gain, abs=1.0 + 0.1 * tried.power**2)


@pytest.mark.parametrize(("name", "size"), [("input.slew_limit", 0.5), ("input.saturation", 2.0), ("input.lag", 0.05)])
def test_what_is_there_is_worth_a_pass(name: str, size: float) -> None:
    # Truth: an effect whose part the plant's thrust has taken, some standard deviations off.
    effect = library(arm())[name]
    (there,) = promised(seen_in(arm_log({name: {effect.size.symbol: size}})), tries(name, (size,)))
    assert there.is_worth
    assert there.gain > 10.0


def test_far_more_than_is_there_is_not() -> None:
    (far,) = promised(seen_in(arm_log({"input.lag": {"tau": 0.05}})), tries("input.lag", (0.5,)))
    assert not far.is_worth
    assert far.gain < -100.0


def test_nothing_that_is_not_there_is_worth_a_pass() -> None:
    # Truth: none. By chance one in a thousand gains as much as is asked.
    linearisation = plain_linearisation()
    asked = [*tries("input.saturation", np.linspace(1.2, 2.6, 8).tolist()), *tries("input.lag", (0.02, 0.1, 0.3))]
    assert not any(promise.is_worth for promise in promised(linearisation, asked))


def test_what_one_log_shows_and_others_deny_is_worth_a_pass() -> None:
    # Truth: commands are cut at 2 V in the last of three logs.
    logs = [arm_log(seed=1), arm_log(seed=2), arm_log({"input.saturation": {"limit": 2.0, "w": 0.0}}, seed=3)]
    (promise,) = promised(seen_in(*logs), tries("input.saturation", (2.0,)))
    assert promise.gain < 0.0
    assert promise.is_worth


def test_what_changes_commands_at_instants_of_its_own_or_none_promises_nothing() -> None:
    # Delays by parts of a row bring instants; what an encoder does is on no input's way; steps hit or miss as a whole.
    linearisation = plain_linearisation()
    asked = [*tries("input.delay", (0.0123,)), *tries("theta_sensor.lag", (0.1,)), *tries("input.quantization", (0.1,))]
    assert promises(linearisation, asked) == [None] * 3


def test_a_level_beyond_all_commands_leaves_no_trace() -> None:
    (never,) = promised(seen_in(arm_log(seconds=LONG_S)), tries("input.saturation", (29.0,)))
    assert (never.power, never.is_worth) == (0.0, False)


def test_where_an_input_pushes_now_one_way_now_the_other_passes_are_made(tmp_path: Path) -> None:
    # Truth: an arm that is pushed by the square of its input, which swings about 0: in the mean a little more of it does nothing.
    squared = OwnPlant(PLAIN.parameters, PLAIN.sensors, PLAIN.body.replace('p["K"] * u -', 'p["K"] * u**2 -'))
    bound = bind(load_plant(squared.write(tmp_path, "square")))
    t_s = 0.01 * np.arange(600)
    u = 3.0 * np.sin(2.0 * t_s) + 2.0 * np.sin(5.0 * t_s)
    run = simulate(bound, t_s, np.zeros(2), u[:, None], Conditions(keep="y"))
    y = np.asarray(run.y).reshape(len(t_s), -1)
    case = make_case(effect_library(bound), [RunLog(log_columns(bound.model), 0.01, "open", t_s, u[:, None], y)])
    linearisation = linearised(case, nominal_fit(case))
    effect = library(bound)["input.saturation"]
    (promise,) = promised(linearisation, [(effect, {**effect.absent, effect.size.symbol: 3.0})])
    assert turns(linearisation, 0)
    assert promise.is_worth
    assert not turns(plain_linearisation(), 0)
