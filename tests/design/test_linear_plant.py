"""The part that an input moves and an output shows: equal parts side by side are one, a chain of equal ones stays whole."""

import numpy as np
import pytest

from design.linear_plant import LinearPlant, minimal


def markov(plant: LinearPlant, count: int = 6) -> list[float]:
    """C A^k B for k = 0 .. count - 1: what the input does to the output, whatever the states are."""
    return [(plant.C @ np.linalg.matrix_power(plant.A, k) @ plant.B).item() for k in range(count)]


def side_by_side(rates: tuple[float, ...], units: tuple[float, ...]) -> LinearPlant:
    """dx_i/dt = rate_i (u - x_i), y their sum, each x_i counted in a unit of its own."""
    size = np.array(units)
    return LinearPlant(np.diag(rates), -(np.array(rates) / size)[:, np.newaxis], size[np.newaxis])


@pytest.mark.parametrize(
    ("rates", "units", "order"),
    [
        ((-0.04, -0.04), (1.0, 1.0), 1),
        ((-50.0, -50.0), (1.0, 1e6), 1),
        ((-3.0, -3.0, -3.0), (0.1, 7.0, 1e-3), 1),
        ((-3.0, -3.0, -200.0), (1.0, 1.0, 1.0), 2),
        ((-3.0, -3.0000001), (1.0, 1.0), 2),
    ],
)
def test_equal_parts_are_one_whatever_their_units(
    rates: tuple[float, ...], units: tuple[float, ...], order: int
) -> None:
    # Truth: parts of one rate answer an input as one; those of two rates are two.
    plant = side_by_side(rates, units)
    part = minimal(plant)
    assert len(part.A) == order
    np.testing.assert_allclose(markov(part), markov(plant), rtol=1e-9)


def test_what_is_moved_and_never_shown_is_left_out_too() -> None:
    # Truth: x_2 follows x_1 and no output has it.
    plant = LinearPlant(np.array([[-2.0, 0.0], [5.0, -7.0]]), np.array([[3.0], [0.0]]), np.array([[1.0, 0.0]]))
    part = minimal(plant)
    np.testing.assert_allclose([part.A.item(), (part.C @ part.B).item()], [-2.0, 3.0])


@pytest.mark.parametrize("rate", [0.0, -0.04, -1e4])
@pytest.mark.parametrize("order", [2, 3, 5])
def test_a_chain_of_equal_lags_or_integrators_stays_as_it_is(rate: float, order: int) -> None:
    # Truth: one Jordan block is moved by the first and shown by the last, all of it.
    A = rate * np.eye(order) + np.eye(order, k=-1) * (abs(rate) or 1.0)
    plant = LinearPlant(A, np.eye(order)[:, :1], np.eye(order)[-1:])
    assert minimal(plant) is plant


def test_a_difference_that_grows_or_stays_is_not_forgotten() -> None:
    for rate in (0.0, 0.3):
        alike = LinearPlant(rate * np.eye(2), np.ones((2, 1)), np.ones((1, 2)))
        assert minimal(alike) is alike


def test_a_weak_coupling_between_slow_and_fast_is_none_of_it() -> None:
    # Truth: a slow state that moves by a millionth of the fast one's rate is moved all the same.
    plant = LinearPlant(np.array([[-1e4, 0.0], [1e-6, -1e-2]]), np.array([[1.0], [0.0]]), np.array([[0.0, 1.0]]))
    assert minimal(plant) is plant
