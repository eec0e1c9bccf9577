"""Rows are put in the order of their times only where nothing but their order is wrong."""

import numpy as np
import pytest

from recordings.row_order import NEWEST_FIRST, in_time
from recordings.signals import Contents, Signal

T_S = 0.01 * np.arange(200)
ORDER = np.random.default_rng(3).permutation(len(T_S))


def contents(t_s: np.ndarray, faults: dict[int, str] | None = None) -> Contents:
    return Contents({"t_s": Signal(t_s, "s", "t_s"), "psi_rad": Signal(np.sin(t_s), "rad", "t_s", faults=faults or {})})


def test_a_fault_goes_with_its_row() -> None:
    """Truth: of rows in the order ORDER the one at place 5 was row ORDER[5]."""
    put = in_time(contents(T_S[ORDER], {5: "'abc'"}))
    np.testing.assert_array_equal(put.signals["t_s"].values, T_S)
    np.testing.assert_array_equal(put.signals["psi_rad"].values, np.sin(T_S))
    assert put.signals["psi_rad"].faults == {int(ORDER[5]): "'abc'"}
    assert put.found == (
        f"{np.count_nonzero(np.arange(len(ORDER)) != ORDER)} rows stand in another order than their times: put in order",
    )


@pytest.mark.parametrize(
    "t_s",
    [
        pytest.param(T_S, id="in order"),
        pytest.param(np.concatenate([T_S, T_S]), id="two recordings of one clock"),
        pytest.param(np.concatenate([T_S, T_S - 0.3037]), id="a clock that was set back"),
        pytest.param(np.concatenate([T_S + 60.0, T_S]), id="ticks that ran over"),
        pytest.param(np.random.default_rng(5).uniform(0.0, 2.0, 200), id="times by chance, which are no clock"),
        pytest.param(np.where(np.arange(200) == 50, np.nan, T_S)[ORDER], id="a row without a time"),
    ],
)
def test_what_more_is_wrong_with_stays_as_it_is(t_s: np.ndarray) -> None:
    given = contents(t_s)
    assert in_time(given) is given


def test_of_two_clocks_none_is_put_in_order() -> None:
    given = contents(T_S[ORDER])
    two = Contents({**given.signals, "t2_s": Signal(T_S, "s", "t2_s")})
    assert in_time(two) is two


def test_of_several_clocks_that_all_fall_every_row_is_turned_round() -> None:
    """Truth: two clocks of their own lengths, each with its newest row first."""
    slow = T_S[::4]
    first = contents(T_S[::-1]).signals
    further = {"t2_s": Signal(slow[::-1], "s", "t2_s"), "phi_rad": Signal(np.cos(slow)[::-1], "rad", "t2_s")}
    put = in_time(Contents({**first, **further, "one": Signal(np.asarray(3.0))}))
    np.testing.assert_array_equal(put.signals["psi_rad"].values, np.sin(T_S))
    np.testing.assert_array_equal(put.signals["t2_s"].values, slow)
    np.testing.assert_array_equal(put.signals["phi_rad"].values, np.cos(slow))
    assert put.found == (NEWEST_FIRST,)
