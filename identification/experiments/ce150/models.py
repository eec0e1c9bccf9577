"""The subsystems of seed 000 that its experiments excite, each as small equations over the parameters of the whole plant.

A mount turned by 90 degrees changes the direction in which gravity acts: on the elevation by tau_gE cos(Psi + mount), and on the azimuth,
whose axis then lies level, by -tau_gE cos(Psi) sin(Phi). A locked axis is no state.
"""

from functools import cache
from typing import Any

import sympy

from sim.model import Axis, Model, ParameterSpec, named_symbols, odd_polynomial, polynomial, symbol
from sim.plants import ce150

OMEGA, TURN, U = symbol("omega_rad_s"), symbol("turn_rad"), symbol("u_V")
TURNING = symbol("turning_rad_s")  # azimuth speed, given by the hand
WEIGHT, BALANCE_PSI = symbol("weight_kg"), symbol("balance_psi_rad")
_SPECS = {spec.name: spec for spec in ce150.PARAMETERS}
MOUNT = ParameterSpec("mount_rad", 1, "rad")
TURNED = ParameterSpec("turned", 1, "-")
PSI_LOCKED = ParameterSpec("psi_locked_rad", 1, "rad")
ANY = (-sympy.oo, sympy.oo)
ROTOR = (
    ParameterSpec("p_b", 3, "[s^-1, rad^-1, rad^-2 s]"),
    ParameterSpec("K", 1, "rad s^-2 V^-1"),
    ParameterSpec("p_F", 5, "[N, N s, N s^2, N s^3, N s^4]"),
)


@cache
def rotor() -> Model:
    """Eqs (4), (5): speed and angle of one rotor; its parameters go by the names p_b, K, p_F of either."""
    p = named_symbols(ROTOR)
    return Model(
        name="rotor_rig",
        states=(OMEGA, TURN),
        inputs=(U,),
        outputs={"omega_rad_s": OMEGA, "turn_rad": TURN},
        parameters=ROTOR,
        rates={OMEGA: p["K"] * U - polynomial(p["p_b"], sympy.Abs(OMEGA)) * OMEGA, TURN: OMEGA},
        axes=(),
        input_limits={U: ANY},
    )


def rotor_readings() -> tuple[sympy.Expr, ...]:
    """Angle of the rotor, and its thrust by eqs (6), (7)."""
    return TURN, odd_polynomial(named_symbols(ROTOR)["p_F"], OMEGA)


@cache
def elevation() -> Model:
    """Eqs (4), (8) with the azimuth locked, or turned by hand at a given speed."""
    names = (
        "l_M",
        "p_bM",
        "K_M",
        "p_FM",
        "J_E",
        "tau_gE",
        "b_vE",
        "b_cE",
        "K_E",
        "g",
        "Psi_lim",
        "cf_sign",
        "cf_length",
    )
    specs = (*(_SPECS[name] for name in names), MOUNT)
    p = named_symbols(specs)
    omega, psi, psi_dot = ce150.OMEGA_M, ce150.PSI, ce150.PSI_DOT
    centrifugal = p["cf_sign"] * p["tau_gE"] * p["cf_length"] / (2 * p["g"]) * TURNING**2 * sympy.sin(2 * psi)
    torque = (
        p["l_M"] * odd_polynomial(p["p_FM"], omega)
        + centrifugal
        - p["tau_gE"] * sympy.cos(psi + p["mount_rad"])
        - p["b_vE"] * psi_dot
        + p["K_E"] * TURNING * omega * sympy.sin(psi)
    )
    return Model(
        name="elevation_rig",
        states=(omega, psi, psi_dot),
        inputs=(ce150.U_M, TURNING),
        outputs={"psi_rad": psi},
        parameters=specs,
        rates={omega: _main_rotor(p), psi: psi_dot},
        axes=(Axis("elevation", psi, psi_dot, p["J_E"], torque, p["b_cE"], -p["Psi_lim"], p["Psi_lim"]),),
        input_limits={ce150.U_M: ANY, TURNING: ANY},
    )


@cache
def azimuth() -> Model:
    """Eqs (5), (9) with the elevation locked and the main rotor at rest."""
    names = ("l_T", "p_bT", "K_T", "p_FT", "tau_gE", "J_A", "b_vA", "b_cA", "Phi_lim")
    specs = (*(_SPECS[name] for name in names), TURNED, PSI_LOCKED)
    p = named_symbols(specs)
    omega, phi, phi_dot = ce150.OMEGA_T, ce150.PHI, ce150.PHI_DOT
    lean = sympy.cos(p["psi_locked_rad"])
    gravity = p["turned"] * p["tau_gE"] * lean * sympy.sin(phi)
    torque = p["l_T"] * odd_polynomial(p["p_FT"], omega) * lean - p["b_vA"] * phi_dot - gravity
    return Model(
        name="azimuth_rig",
        states=(omega, phi, phi_dot),
        inputs=(ce150.U_T,),
        outputs={"phi_rad": phi},
        parameters=specs,
        rates={omega: _tail_rotor(p), phi: phi_dot},
        axes=(Axis("azimuth", phi, phi_dot, p["J_A"] * lean, torque, p["b_cA"], -p["Phi_lim"], p["Phi_lim"]),),
        input_limits={ce150.U_T: ANY},
    )


@cache
def reaction() -> Model:
    """Eqs (4), (5): both rotors, for the balance of their torques on the azimuth."""
    names = ("l_T", "p_bM", "K_M", "p_bT", "K_T", "p_FT", "K_A")
    specs = tuple(_SPECS[name] for name in names)
    p = named_symbols(specs)
    states = (ce150.OMEGA_M, ce150.OMEGA_T)
    return Model(
        name="reaction_rig",
        states=states,
        inputs=(ce150.U_M, ce150.U_T),
        outputs={str(state): state for state in states},
        parameters=specs,
        rates={ce150.OMEGA_M: _main_rotor(p), ce150.OMEGA_T: _tail_rotor(p)},
        axes=(),
        input_limits={ce150.U_M: ANY, ce150.U_T: ANY},
    )


def reaction_torque() -> tuple[sympy.Expr, ...]:
    """What eq (9) leaves on an azimuth at rest [N m]: l_T F_T - K_A omega_M."""
    p = named_symbols(reaction().parameters)
    return (p["l_T"] * odd_polynomial(p["p_FT"], ce150.OMEGA_T) - p["K_A"] * ce150.OMEGA_M,)


@cache
def gravity() -> Model:
    """Eq (11): an arm balanced by a weight at its tail; nothing moves, so there is no state."""
    specs = (
        _SPECS["tau_gE"],
        _SPECS["g"],
        ParameterSpec("Psi_m", 1, "rad"),
        ParameterSpec("lever", 1, "m"),
        ParameterSpec("lever_angle", 1, "rad"),
    )
    return Model("gravity_rig", (), (BALANCE_PSI, WEIGHT), {}, specs, {}, (), {BALANCE_PSI: ANY, WEIGHT: ANY})


def gravity_torque() -> tuple[sympy.Expr, ...]:
    """Eq (11) as what is left of both torques [N m]: tau_gE cos(Psi + Psi_m) - l m g cos(Psi + Psi_l)."""
    p = named_symbols(gravity().parameters)
    arm = p["tau_gE"] * sympy.cos(BALANCE_PSI + p["Psi_m"])
    return (arm - p["lever"] * WEIGHT * p["g"] * sympy.cos(BALANCE_PSI + p["lever_angle"]),)


def _main_rotor(p: Any) -> sympy.Expr:
    return p["K_M"] * ce150.U_M - polynomial(p["p_bM"], sympy.Abs(ce150.OMEGA_M)) * ce150.OMEGA_M


def _tail_rotor(p: Any) -> sympy.Expr:
    return p["K_T"] * ce150.U_T - polynomial(p["p_bT"], sympy.Abs(ce150.OMEGA_T)) * ce150.OMEGA_T
