"""Equations behind switches: the C that leaves out what is off computes what the equations say, whatever is on."""

from dataclasses import replace
from functools import cache
from itertools import combinations

import numpy as np
import pytest
import sympy

from sim.added_effects import library, with_effects
from sim.bind import BoundPlant
from sim.composition.build import switched_model
from sim.composition.switch import switch_name
from sim.effect import Role, coefficient
from sim.kernel.generate import model_header
from sim.kernel.kernel import C_DIR
from sim.kernel.reference import reference
from sim.kernel.sincos import sincos_header
from sim.model import Model
from sim.plants import MODELS
from sim.symbolic.switches import Line, levels, vanishing
from tests.plants import bound
from tests.soak import SOAK, sampled
from toolchain.host import FAST_FLAGS, CText, build_shared, c_text, load_shared

ARGUMENTS = "const double *p, double t_s, const double *x, const double *u, const double *sign, double *dx, double *A, double *D"
DECLARATION = f"void seen({ARGUMENTS})"
SEEN = f"""
#define LANES 1
#include "lane.h"
#include "sincos.h"
#include "model.h"

{DECLARATION}
{{
    double c[N_CONSTANTS], move[N_AXES + 1], torque[N_AXES + 1], up[N_AXES + 1], down[N_AXES + 1];
    for (int a = 0; a < N_AXES; a++)
        move[a] = 1.0;
    model_constants(p, c);
    model_rates(t_s, x, u, c, sign, move, dx, torque, up, down);
    model_state_slopes(t_s, x, u, c, sign, A);
    model_parameter_slopes(t_s, x, u, c, sign, D);
}}
"""


@cache
def carried(name: str) -> tuple[str, ...]:
    """The effects that a diagnosis has in a plant's equations: those without states or axes of their own."""
    plant = bound(name)
    size = len(plant.model.states), len(plant.model.axes)
    found = []
    for name, effect in library(plant).items():
        if effect.on_equations and not name.endswith(("_sensor.lag", "_input.lag", "input.slew_limit")):
            model = with_effects(plant, {name: {}}).model
            if (len(model.states), len(model.axes)) == size:
                found.append(name)
    # An effect of two axes has the same equations on both: one of each kind will do, but for a soak.
    kinds = {name.partition(".")[2]: name for name in found}
    return tuple(found if SOAK else kinds.values())


@pytest.fixture(scope="module", params=sampled(["ce150", "aeroshield"], keep=["aeroshield"]))
def plant(request: pytest.FixtureRequest) -> BoundPlant:
    return bound(request.param)


@pytest.fixture(scope="module")
def model(plant: BoundPlant) -> Model:
    return switched_model(plant.nominal, carried(plant.plant.name))


def compiled(model: Model):
    made = (
        CText("model.h", model_header(model)),
        CText("sincos_coefficients.h", sincos_header()),
        CText("seen.c", SEEN),
    )
    headers = [c_text(C_DIR / name) for name in ("lane.h", "sincos.h")]
    # Called a hundred times: what the compiler would need for faster code is more than that code could save.
    ffi, lib = load_shared(
        f"{DECLARATION};", build_shared("switches", (*made, *headers), flags=("-O0", *FAST_FLAGS[1:]))
    )
    states, parameters = len(model.states), len(model.parameter_symbols)

    def seen(p, t_s, x, u, sign):
        dx, A, D = np.zeros(states), np.zeros((states, states)), np.zeros((states, parameters))
        lib.seen(*(t_s if v is t_s else ffi.cast("double *", v.ctypes.data) for v in (p, t_s, x, u, sign, dx, A, D)))
        return dx, A, D

    return seen


def numbers(plant: BoundPlant, model: Model, on: set[str]) -> np.ndarray:
    """The vector p with effects of the size of their references, those of `on` switched on."""
    places = {str(symbol): place for place, symbol in enumerate(model.parameter_symbols)}
    effects = library(plant)
    p = np.zeros(len(places))
    p[: len(plant.p)] = plant.p
    for name in carried(plant.plant.name):
        for parameter, symbol in zip(effects[name].parameters, effects[name].symbols, strict=True):
            begins = parameter.role is Role.BEGINNING  # this run does so at 0 s
            p[places[str(symbol)]] = 0.0 if begins else parameter.reference or 0.5 * parameter.upper
        if name in on:
            p[places[switch_name(effects[name])]] = 1.0
    return p


def test_what_is_on_counts_and_what_is_off_does_not(plant: BoundPlant, model: Model) -> None:
    # Truth: C of the same equations that takes a switch for a factor like any other. Rates and slopes within 1e-11 of the largest;
    # slopes by what is off, or by a switch, are nobody's concern.
    seen, plain, names = compiled(model), compiled(replace(model, switches=())), carried(plant.plant.name)
    random = np.random.default_rng(5)
    groups = [(), *((name,) for name in names), *random.permutation(list(combinations(names, 2)))[:100], tuple(names)]
    symbols = [str(symbol) for symbol in model.parameter_symbols]
    own = {name: [symbols.index(str(symbol)) for symbol in library(plant)[name].symbols] for name in names}
    switches = [symbols.index(str(switch)) for switch in model.switches]
    for group in groups:
        p = numbers(plant, model, set(group))
        x, u = random.uniform(-0.6, 0.6, len(model.states)), random.uniform(0.5, 3.0, len(model.inputs))
        sign = random.choice([-1.0, 1.0], len(model.axes))
        unasked = [*(place for name in names if name not in group for place in own[name]), *switches]
        for found, expected in zip(seen(p, 0.7, x, u, sign), plain(p, 0.7, x, u, sign), strict=True):
            if found.shape[-1] == len(p):
                found[:, unasked] = expected[:, unasked] = 0.0
            assert np.abs(expected).max() > 0.0
            np.testing.assert_allclose(
                found, expected, rtol=0.0, atol=1e-11 * np.abs(expected).max(), err_msg=str(group)
            )


@pytest.mark.soak
def test_a_switched_effect_is_the_effect() -> None:
    # Truth: the plant with that effect alone. The others have no size; the corners of those of the input are rounded over 1e-9 V, which
    # moves an input by as much: rates within 1e-9 of the largest.
    plant = bound("aeroshield")
    names, effects = carried(plant.plant.name), library(plant)
    model = switched_model(MODELS["aeroshield"](), names)
    symbols = [str(symbol) for symbol in model.parameter_symbols]
    random, truth = np.random.default_rng(6), reference(model)
    for name in names:
        p = numbers(plant, model, {name})
        for other in set(names) - {name}:
            for parameter, symbol in zip(effects[other].parameters, effects[other].symbols, strict=True):
                p[symbols.index(str(symbol))] = parameter.first
        own = {e.symbol: p[symbols.index(coefficient(name, e.symbol))] for e in effects[name].parameters}
        alone = with_effects(plant, {name: own})
        x, u, sign = random.uniform(-0.6, 0.6, 2), random.uniform(0.5, 3.0, 1), random.choice([-1.0, 1.0], 1)
        expected = reference(alone.model).rates(0.7, x, u, alone.p, sign)
        found = truth.rates(0.7, x, u, p, sign)
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max(), err_msg=name)


def test_what_a_switch_takes_with_it() -> None:
    a, b, x, y, c0, c1 = sympy.symbols("a b x y c0 c1", real=True)
    zeros = {c0: frozenset({a}), c1: frozenset({b})}
    assert vanishing(c0 * sympy.exp(x), zeros) == {a}
    assert vanishing(c0 * x + c1 * y, zeros) == {a, b}
    assert vanishing(c0 * c1 * x, zeros) in ({a}, {b})
    assert vanishing(c0 * x + y, zeros) is None
    assert vanishing(sympy.cos(c0), zeros) is None


def test_what_one_term_alone_needs_is_in_its_block() -> None:
    # Truth, by hand: y = x + c0 exp(v), v = x^2 of use to nobody else; z = y + c1 comes a level later, as y must be complete.
    a, b, x, v, y, c0, c1 = sympy.symbols("a b x v y c0 c1", real=True)
    lines = [Line((v,), x**2), Line((y,), x + c0 * sympy.exp(v)), Line((), sympy.sin(y) + c1 * x, "z")]
    first, second = levels(lines, {c0: frozenset({a}), c1: frozenset({b})})
    assert first.lines == [Line((y,), x)]
    assert first.blocks == {frozenset({a}): [lines[0], Line((y,), c0 * sympy.exp(v), adds=True)]}
    assert second.lines == [Line((), sympy.sin(y), "z")]
    assert second.blocks == {frozenset({b}): [Line((), c1 * x, "z", adds=True)]}
    assert [level.lines for level in levels(lines, {})] == [lines]
