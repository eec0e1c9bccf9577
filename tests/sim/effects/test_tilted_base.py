"""The tilt of the library against a rigid arm on a tilted base, whose torques follow from its potential."""

import sympy

from sim.composition.build import model_with
from sim.effects import effects_for
from sim.plants import MODELS

PSI, PHI = sympy.symbols("psi_rad phi_rad", real=True)
M, PHI_0, E = effects_for(MODELS["ce150"]())["azimuth.tilt"].symbols


def torques() -> tuple[sympy.Expr, sympy.Expr]:
    """What the tilt adds to the elevation and to the azimuth."""
    nominal, tilted = MODELS["ce150"](), model_with(MODELS["ce150"](), ("azimuth.tilt",))
    more = [sympy.expand(b.torque - a.torque) for a, b in zip(nominal.axes, tilted.axes, strict=True)]
    return more[0], more[1]


def test_whatever_the_blend_no_energy_is_won_on_a_round_trip() -> None:
    elevation, azimuth = torques()
    assert sympy.simplify(sympy.diff(elevation, PHI) - sympy.diff(azimuth, PSI)) == 0


def test_whole_it_is_a_rigid_arm_on_a_base_tilted_by_a_small_angle() -> None:
    """The arm's weight hangs at moment / gravity along it; the base leans by `lean` towards phi = Phi_0, which is down there."""
    moment, lean = sympy.symbols("moment lean", positive=True)
    arm = sympy.Matrix([sympy.cos(PSI) * sympy.cos(PHI), sympy.cos(PSI) * sympy.sin(PHI), sympy.sin(PSI)])
    up = sympy.Matrix([-sympy.sin(lean) * sympy.cos(PHI_0), -sympy.sin(lean) * sympy.sin(PHI_0), sympy.cos(lean)])
    potential = moment * arm.dot(up)
    for angle, found in zip((PSI, PHI), torques(), strict=True):
        torque = -sympy.diff(potential, angle)
        by_lean = sympy.diff(torque, lean).subs(lean, 0)
        assert sympy.simplify(by_lean - found.subs({E: 1, M: moment})) == 0, angle


def test_plain_it_is_the_contract_s_sine_on_the_azimuth_alone() -> None:
    elevation, azimuth = torques()
    assert elevation.subs(E, 0) == 0
    assert sympy.simplify(azimuth.subs(E, 0) + M * sympy.sin(PHI - PHI_0)) == 0
