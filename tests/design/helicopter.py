"""The default helicopter with the pole sets that the tests design for."""

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from design.discretise import SampledPlant, sample
from design.linearise import linearise, subsystem
from design.loop import PlantPolynomials, plant_polynomials
from design.operating_points import design_points
from design.pole_placement import FreeDegree, Placement, demand_usable, placed_in_z
from design.settings import AxisSettings, DesignSettings, read_settings
from design.table import make_table
from records.plant import load_plant
from records.table import ControllerTable
from sim.bind import BoundPlant, bind
from sim.equilibrium import equilibrium

PLANT = Path(__file__).parents[2] / "plants" / "ce150.toml"
SAMPLE_PERIOD_S = 0.01

DOM = (-2.5 + 1.5j, -2.5 - 1.5j, -7.0, -10.0, -12.0, -15.0)
DOM2 = (-3.0, -4.0, -7.0, -12.0, -15.0, -20.0)
AZ_DOM = (-1.5 + 1.0j, -1.5 - 1.0j, -3.5, -5.0, -6.0, -7.0)


def equal(pole: float) -> tuple[float, ...]:
    """Six equal poles [rad/s]."""
    return (pole,) * 6


@cache
def helicopter() -> BoundPlant:
    return bind(load_plant(PLANT))


@cache
def base_settings() -> DesignSettings:
    """Settings that do not depend on the wishes in the plant file: 17 points over +-40 deg, degrees 3 and 2."""
    bare = replace(helicopter().plant, design={})
    return read_settings(bind(bare))


def axis_settings(axis: str, poles: tuple[complex, ...], free_degree: str) -> AxisSettings:
    wishes = base_settings().axis(axis)
    return replace(
        wishes,
        poles_rad_s=tuple(complex(pole) for pole in poles),
        roll_off_pole_rad_s=0.0,
        coefficient_degree=None,
        free_degree=free_degree,
    )


@cache
def settings_for(
    elevation: tuple[tuple[complex, ...], str] = (DOM2, "integral"),
    azimuth: tuple[tuple[complex, ...], str] = (AZ_DOM, "integral"),
    coefficient_degree: int = 3,
) -> DesignSettings:
    return replace(
        base_settings(),
        axes=(axis_settings("elevation", *elevation), axis_settings("azimuth", *azimuth)),
        coefficient_degree=coefficient_degree,
        recursion_degree=coefficient_degree,
    )


@cache
def table_for(settings: DesignSettings) -> ControllerTable:
    return make_table(helicopter(), settings, design_points(helicopter(), settings))


@cache
def polynomials(axis: str, psi_rad: float) -> PlantPolynomials:
    """The same in powers of gamma."""
    return plant_polynomials(sampled(axis, psi_rad))


@cache
def sampled(axis: str, psi_rad: float) -> SampledPlant:
    """The sampled plant of one axis at an elevation."""
    linear = linearise(helicopter(), equilibrium(helicopter(), psi_rad))
    return sample(subsystem(helicopter(), linear, base_settings().loop(axis)), SAMPLE_PERIOD_S)


def place(b: np.ndarray, a: np.ndarray, wanted: np.ndarray, free: FreeDegree, where: str) -> Placement:
    """Eq (26) solved in powers of z^-1, and judged."""
    placement = placed_in_z(b, a, wanted, free)
    demand_usable(placement, where)
    return placement


def wide_angles() -> np.ndarray:
    """85 angles in +-42 deg, a little beyond the schedule."""
    return np.radians(np.linspace(-42.0, 42.0, 85))


def deg(angle_rad: float) -> float:
    return math.degrees(angle_rad)
