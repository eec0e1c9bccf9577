"""Plants, a controller and small mechanisms with known motion, shared by the tests of sim/."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import sympy

from records.plant import Plant, load_plant
from records.table import ControllerTable
from sim.bind import BoundPlant, bind
from sim.model import TIME, Axis, Model, ParameterSpec, symbol
from tests.plants import stated_table

PLANTS = Path(__file__).parents[2] / "plants"
POSITION, VELOCITY, FORCE = symbol("s_m"), symbol("v_m_s"), symbol("u_N")
Mechanism = Callable[..., BoundPlant]


@pytest.fixture(scope="session")
def bound() -> BoundPlant:
    """The CE150."""
    return bind(load_plant(PLANTS / "ce150.toml"))


@pytest.fixture(scope="session")
def literal() -> BoundPlant:
    """The CE150 as the paper prints it."""
    return bind(load_plant(PLANTS / "ce150_seed_literal.toml"))


@pytest.fixture(scope="session")
def table(bound: BoundPlant) -> ControllerTable:
    """The controller of the CE150's plant file."""
    return stated_table("ce150")


@pytest.fixture(scope="session")
def mechanism() -> Mechanism:
    """A body of `mass` that slides along s with dry friction `friction` between stops at +-`limit`.

    Driven by u plus `force`, an expression of s, v and the time.
    """
    names = ("mass", "friction", "limit")
    mass, friction, limit = (symbol(name) for name in names)

    def build(force: sympy.Expr | float = 0.0, values: tuple[float, float, float] = (2.0, 0.5, 10.0)) -> BoundPlant:
        model = Model(
            name="mechanism",
            states=(POSITION, VELOCITY),
            inputs=(FORCE,),
            outputs={"s_m": POSITION},
            parameters=tuple(ParameterSpec(name, 1, "1") for name in names),
            rates={POSITION: VELOCITY},
            axes=(Axis("slide", POSITION, VELOCITY, mass, FORCE + force, friction, -limit, limit),),
            input_limits={FORCE: (sympy.Integer(-100), sympy.Integer(100))},
        )
        plant = Plant("mechanism", "mechanism", {}, {"s_m": 1e-12})
        return BoundPlant(plant, model, np.array(values), np.zeros(3))

    return build


@pytest.fixture(scope="session")
def time_s() -> sympy.Symbol:
    """The time as it may stand in a model's equations."""
    return TIME
