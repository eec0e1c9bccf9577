"""What the data tell of a parameter, apart from what it was given as its size, and what counts where they tell it poorly."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from identification.fit.belief import Belief, stated
from identification.results.result import Identification, identification, signs_of
from identification.results.told import combined
from identification.stages.holdout import prediction_tests
from identification.stages.logs import Asked, identify_logs
from records.log import RunLog
from records.plant import load_plant
from sim.bind import BoundPlant, bind
from sim.columns import log_columns
from sim.simulate import simulate
from tests.own_plants import ARM, PLAIN, OwnPlant

Array = NDArray[np.float64]
STANDING = replace(PLAIN, body=PLAIN.body.replace('- p["G"]', '+ p["G"]'))
TRUE = {name: value for name, (value, _, _) in ARM.items()}
HELD_UP_V_rad, HELD_UP_V_s_rad = 16.0, 1.5  # a law that holds the standing arm up


def _pushed(arm: BoundPlant) -> RunLog:
    """15 s of steps of the input, each half a second long."""
    t_s = 0.01 * np.arange(1500)
    u = np.repeat(np.random.default_rng(1).uniform(-3.0, 3.0, 30), 50)[:, None]
    return RunLog(log_columns(arm.model), 0.01, "open", t_s, u, simulate(arm, t_s, [0.0, 0.0], u).y)


def _held_up(arm: BoundPlant) -> RunLog:
    """15 s of an arm that would fall, after a reference that steps each second, by the readings and their slopes."""
    t_s = 0.01 * np.arange(1500)
    wanted = np.repeat(np.random.default_rng(3).uniform(-0.5, 0.5, 15), 100)
    x, u, y = np.zeros((1, 2)), np.zeros((1500, 1)), np.zeros((1500, 1))
    for k in range(1500):
        y[k] = 1.5e-3 * np.round(x[-1, 0] / 1.5e-3)
        u[k] = HELD_UP_V_rad * (wanted[k] - y[k]) - HELD_UP_V_s_rad * (y[k] - y[max(k - 1, 0)]) / 0.01
        x = simulate(arm, [0.0, 0.01], x[-1], np.vstack([u[k], u[k]])).x
    return RunLog(log_columns(arm.model), 0.01, "closed", t_s, u, y)


FLIGHTS: Mapping[str, tuple[OwnPlant, Callable[[BoundPlant], RunLog]]] = {
    "hanging": (PLAIN, _pushed),
    "standing": (STANDING, _held_up),
}


def _stated(folder: Path, arm: OwnPlant, known: Mapping[str, tuple[float, float]]) -> BoundPlant:
    """The arm as a plant file states it, with these values and sd of its parameters."""
    parameters = {name: (*known.get(name, (value, sd)), unit) for name, (value, sd, unit) in arm.parameters.items()}
    return bind(load_plant(replace(arm, parameters=parameters).write(folder, "arm")))


def _log(folder: Path, which: str) -> RunLog:
    arm, flown = FLIGHTS[which]
    return flown(bind(load_plant(arm.write(folder / "true", "arm"))))


def _found(file: BoundPlant, log: RunLog, names: tuple[str, ...], asked: Asked | None = None) -> Identification:
    fit = identify_logs(file, {"log": log}, names, asked or Asked())
    return identification(file.plant, [("log", fit)], fit.belief, signs=signs_of(file.model))


def _value(found: Identification, name: str) -> float:
    return found.plant.parameters[name].values[0]


def _fits(found: Identification, log: RunLog) -> None:
    """plant.toml tells the log to what its encoder leaves, and the shares of all torques to 1 %."""
    for name in ("J", "G", "b"):
        share = _value(found, name) / _value(found, "K")
        assert share == pytest.approx(TRUE[name] / TRUE["K"], rel=0.01)
    (test,) = prediction_tests(bind(found.plant), {"log": log})
    assert test.rms < 1.1 * test.noise


def test_what_only_a_common_factor_holds_is_not_told(tmp_path: Path) -> None:
    """Truth: every torque and the inertia are known to a common factor alone, at any size that the file gives them.

    By the share that each has in that factor they looked told, to 29 %.
    """
    file = _stated(tmp_path, PLAIN, {"K": (0.01, 0.005)})
    assert [
        entry.name for entry in _found(file, _log(tmp_path, "hanging"), tuple(TRUE)).estimates if entry.identified
    ] == []


@pytest.mark.parametrize("which", FLIGHTS)
def test_what_is_written_where_a_factor_is_open_fits_and_has_it_from_the_file(tmp_path: Path, which: str) -> None:
    """Truth: the arm that made the log, within every interval of 95 %.

    The file has b from 5 % above it, to 10 %, and guesses the rest at 0.6 of it, each to 60 %: a factor of 0.96 to 9 %. No row tells the
    factor. The slopes of an arm that would fall grow until rounding looks as if it did.
    """
    guessed = {name: (0.6 * TRUE[name], 0.6 * TRUE[name]) for name in ("J", "K", "G")}
    file = _stated(tmp_path, FLIGHTS[which][0], {**guessed, "b": (1.05 * TRUE["b"], 0.1 * TRUE["b"])})
    log = _log(tmp_path, which)
    found = _found(file, log, tuple(TRUE))
    _fits(found, log)
    for entry in found.estimates:
        assert not entry.identified
        assert entry.lower < TRUE[entry.name] < entry.upper
        assert entry.sd / entry.value == pytest.approx(0.09, abs=0.02)
        assert found.plant.parameters[entry.name].sds == (entry.sd,)
        assert _value(found, entry.name) == entry.value
    rows = np.array(found.plant.correlation.rows) if found.plant.correlation else np.zeros((4, 4))
    assert rows.min() > 0.98  # nothing but the common factor is open


def test_what_the_file_has_no_sd_of_stays_in_the_fit(tmp_path: Path) -> None:
    """Truth: shares of torques as of the arm that made the log; a file without any sd says nothing of their factor."""
    file = _stated(tmp_path, PLAIN, {"J": (0.01, 0.0), "K": (0.02, 0.0), "G": (0.2, 0.0), "b": (0.02, 0.0)})
    log = _log(tmp_path, "hanging")
    _fits(_found(file, log, tuple(TRUE)), log)


def test_what_the_file_knows_counts_once(tmp_path: Path) -> None:
    """Truth: asked for as data (--prior) it is in the fit before, and nothing is added to it."""
    file = _stated(tmp_path, PLAIN, {name: (value, 0.6 * value) for name, value in TRUE.items()})
    known = stated(file)
    found = _found(file, _log(tmp_path, "hanging"), known.names, Asked(before=known))
    ((_, fit),) = found.stages
    assert not any(entry.identified for entry in found.estimates)
    assert found.estimates[0].value == fit.belief.value(found.estimates[0].name)
    assert [entry.value for entry in found.estimates] == [entry.by_data for entry in found.estimates]


def test_two_normal_beliefs_make_one() -> None:
    """Truth: informations add. x + y is known to 1, x - y to 10, and y besides as 3 to 2."""
    turn = np.array([[1.0, 1.0], [1.0, -1.0]])
    information = turn.T @ np.diag([1.0, 0.01]) @ turn
    both = combined(
        Belief(("x", "y"), np.zeros(2), np.linalg.inv(information)), Belief(("y",), np.array([3.0]), np.eye(1) * 4.0)
    )
    added = information + np.diag([0.0, 0.25])
    np.testing.assert_allclose(both.covariance, np.linalg.inv(added))
    np.testing.assert_allclose(both.mean, np.linalg.solve(added, [0.0, 0.75]))


def test_with_one_of_them_held_the_others_are(tmp_path: Path) -> None:
    """Truth: the plant that made the log, to 3 sd."""
    for entry in _found(
        bind(load_plant(PLAIN.write(tmp_path, "arm"))), _log(tmp_path, "hanging"), ("J", "b", "G")
    ).estimates:
        assert entry.identified
        assert abs(entry.value - TRUE[entry.name]) < 3.0 * entry.sd
