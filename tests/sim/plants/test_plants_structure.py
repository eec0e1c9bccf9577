"""Every plant file parses, binds, keeps to the contract's columns, and has finite derivatives that equal finite differences."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest

from records.plant import load_plant, parse_plant, plant_text
from sim.columns import log_columns
from sim.kernel.reference import reference
from sim.simulate import Conditions, simulate
from tests.plants import PLANTS, bound

CONTRACT = {  # columns after t_s as the contract has them, then any of the optional ones; axes
    "quanser_aero": (
        "u_M_V,u_T_V,theta_rad,psi_rad",
        "theta_dot_rad_s,psi_dot_rad_s,omega_M_rad_s,omega_T_rad_s,theta_ref_rad,psi_ref_rad",
        "pitch yaw",
    ),
    "ce150_velagic": (
        "u_M_V,u_T_V,psi_rad,phi_rad",
        "omega_M_rad_s,omega_T_rad_s,psi_dot_rad_s,phi_dot_rad_s,psi_ref_rad,phi_ref_rad",
        "elevation azimuth",
    ),
    "aeroshield": ("u_V,theta_rad", "theta_ref_rad", "arm"),
    "aeroshield_two_clocks": ("u_V,theta_rad", "theta_ref_rad,t_host_s", "arm"),
    "antx_2dof_drone": ("M,theta_rad,q_rad_s", "theta_ref_rad,q_ref_rad_s", "pitch"),
    "emps": ("u_V,q_m", "q_ref_m", "carriage"),
    "pamh_aeropendulum": ("u_V,theta_rad", "theta_ref_rad", "arm"),
    "maglev_coil": ("u_1,i_A", "i_ref_A", ""),
    "torque_limited_pendulum": ("tau_Nm,theta_rad", "theta_dot_rad_s,theta_ref_rad", "pendulum"),
}
PUBLISHED = {  # what the authors state, SI
    "quanser_aero": "dt=0.158 me=0.2 dx=0.016 mpa=0.146 lt=0.165 mrod=0.458 ry=0.02 my=0.526 g=9.81 K_omega=17.38 u_max=24 "
    "Kmt=1.26e-6 Ktp=1.26e-6 Ktt=1.08e-6 Kmp=1.08e-6 d1=0.0031 d2=0.0075",
    "ce150_velagic": "T_1=0.1 T_2=0.25 a_1=0.1165 b_1=0.062 B_psi=0.08 tau_G=0.071 I_inv=184 a_2=0.268 b_2=0.0408 B_phi=0.04 "
    "Ic_inv=494.3 a_3=0.1959 b_3=0.0202 k_G=0.3185",
    "aeroshield": "m=0.005 l=0.1 c=0.001 K=0.01 g=9.81",
    "antx_2dof_drone": "omega_n=2.9499 xi=0.1817 mu=404.87608841 tau=0.0196",
    "emps": "M=95.11 F_v=203.5 gtau=35.15 u_max=10 F_c=0 offset=0",  # dry friction is published too, and left to be found
    "pamh_aeropendulum": "b=5.3807 d=0.1984 k=15.657",
    "maglev_coil": "k=11.658 R=4.17 L=0.1",
    "torque_limited_pendulum": "J=0.169 G=3.31 b=0.1 tau_c=0",  # dry friction is left to be found
}
recorded_plant = pytest.mark.parametrize("name", list(CONTRACT))


@recorded_plant
def test_a_plant_file_reads_back_equal(name: str) -> None:
    plant = load_plant(PLANTS / f"{name}.toml")
    assert parse_plant(tomllib.loads(plant_text(plant)), name, "text") == plant
    assert all(parameter.source for parameter in plant.parameters.values())


@recorded_plant
def test_columns_and_axes_are_those_of_the_contract(name: str) -> None:
    needed, optional, axes = CONTRACT[name]
    columns = log_columns(bound(name).model)
    assert ",".join((*columns.inputs, *columns.outputs)) == needed
    assert set(optional.split(",")) <= set(columns.optional)
    assert " ".join(columns.axes) == axes


@pytest.mark.parametrize("name", list(PUBLISHED))
def test_nominal_parameters_are_the_published_ones(name: str) -> None:
    plant = bound(name)
    stated = dict(item.split("=") for item in PUBLISHED[name].split())
    assert {key: plant.parameter(key) for key in stated} == {key: float(value) for key, value in stated.items()}


@recorded_plant
@pytest.mark.parametrize("seed", range(4))
def test_jacobians_are_finite_and_equal_finite_differences(name: str, seed: int) -> None:
    # Central differences with steps of 1e-5 of the value: 1e-6 relative, beyond the rounding of the difference itself.
    plant = bound(name)
    derived, signs = reference(plant.model), np.zeros(len(plant.model.axes))
    rng = np.random.default_rng(seed)
    x, u = rng.uniform(-0.8, 0.8, len(plant.model.states)), rng.uniform(-1.0, 1.0, len(plant.model.inputs))
    blocks = {
        "A": (derived.A, x, lambda value: derived.rates(0.0, value, u, plant.p, signs)),
        "B": (derived.B, u, lambda value: derived.rates(0.0, x, value, plant.p, signs)),
        "D_p": (derived.D_p, plant.p, lambda value: derived.rates(0.0, x, u, value, signs)),
    }
    for jacobian, at, rates in blocks.values():
        exact = jacobian(0.0, x, u, plant.p, signs)
        assert np.isfinite(exact).all()
        for column, value in enumerate(at):
            step = np.zeros_like(at)
            step[column] = 1e-5 * abs(value) or 1e-5
            slope = (rates(at + step) - rates(at - step)) / (2 * step[column])
            rounding = 1e-14 * np.abs(rates(at)).max() / step[column]
            np.testing.assert_allclose(slope, exact[:, column], rtol=1e-6, atol=abs(rounding))


@recorded_plant
def test_the_compiled_kernel_follows_the_equations(name: str) -> None:
    # One RK4 step of the readable reference, 1e-12 relative; no axis is at rest, no input at a limit.
    plant = bound(name)
    equations, signs = reference(plant.model).rates, np.zeros(len(plant.model.axes))
    x = np.linspace(0.3, 0.6, len(plant.model.states))
    u = np.full((2, len(plant.model.inputs)), 0.7)
    h = 1e-3
    k1 = equations(0.0, x, u[0], plant.p, signs)
    k2 = equations(0.0, x + h / 2 * k1, u[0], plant.p, signs)
    k3 = equations(0.0, x + h / 2 * k2, u[0], plant.p, signs)
    k4 = equations(0.0, x + h * k3, u[0], plant.p, signs)
    run = simulate(plant, [0.0, h], x, u, Conditions(resolution=0.0))
    assert run.x is not None
    np.testing.assert_allclose(run.x[1], x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), rtol=1e-12)


@recorded_plant
def test_an_input_beyond_its_limit_acts_as_the_limit(name: str) -> None:
    plant = bound(name)
    upper = np.array([plant.limits(u)[1] for u in plant.model.inputs])
    lower = np.array([plant.limits(u)[0] for u in plant.model.inputs])
    t_s, x0 = np.arange(50) * 0.002, np.zeros(len(plant.model.states))
    for limit, beyond in ((upper, upper + 6.0), (lower, lower - 6.0)):
        at, over = (simulate(plant, t_s, x0, np.tile(drive, (50, 1))).y for drive in (limit, beyond))
        np.testing.assert_array_equal(over, at)


def test_a_sensor_of_another_quantity_bears_its_own_unit() -> None:
    plant = load_plant(PLANTS / "antx_2dof_drone.toml")
    assert plant.sensors["q_rad_s"] == 1.0e-6
    assert plant.sensor_noise == {"theta_rad": 4.0e-5, "q_rad_s": 2.0e-3}
    assert "resolution_rad_s" in plant_text(plant)
    assert replace(plant, sensor_noise={}) != plant
