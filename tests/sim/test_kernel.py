"""The compiled CE150 against the NumPy reference, against itself with finer steps, and single against batched."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
import sympy

from records.errors import BadInput
from sim.equilibrium import equilibrium
from sim.halving import step_error
from sim.kernel.generate import model_header
from sim.kernel.kernel import kernel
from sim.kernel.reference import reference
from sim.manoeuvres import flight, hop
from sim.model import TIME, Axis, symbol
from sim.runs.compiled_run import run_equations
from sim.simulate import CController, Conditions, Noise, simulate
from tests.soak import sampled
from toolchain import host
from toolchain.host import STRICT_FLOAT_FLAGS, CText, build_shared, load_shared

NOWHERE = [0.0, 0.0]  # no quantisation
S, V = sympy.symbols("S V", real=True)


def excited(bound, seconds=1.0, seed=0):
    """Random held inputs about a rest point, both axes moving fast enough not to stop."""
    random = np.random.default_rng(seed)
    point = equilibrium(bound, -0.3)
    t = np.arange(round(seconds * 100) + 1) * 0.01
    u = point.u0 + random.uniform(-0.5, 0.5, (t.size, 2))
    x0 = point.x0 + np.array([0.0, 0.0, 0.9, 0.0, 0.0, -1.4])
    return t, x0, u


def reference_rk4(bound, t, x0, u):
    """Plain RK4 on the NumPy equations with the friction's direction frozen over each step."""
    rates, x = reference(bound.model).rates, [np.array(x0)]
    for k, h in enumerate(np.diff(t)):
        signs, now = np.sign(x[-1][[2, 5]]), x[-1]
        k1 = rates(t[k], now, u[k], bound.p, signs)
        k2 = rates(t[k], now + h / 2 * k1, u[k], bound.p, signs)
        k3 = rates(t[k], now + h / 2 * k2, u[k], bound.p, signs)
        k4 = rates(t[k], now + h * k3, u[k], bound.p, signs)
        x.append(now + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
    return np.array(x)


@pytest.mark.parametrize("which", sampled(["bound", "literal"], keep=["bound"]))
def test_the_kernel_is_the_numpy_reference_to_1e_12(which, request):
    bound = request.getfixturevalue(which)
    t, x0, u = excited(bound, 0.3)
    t = t + np.random.default_rng(1).uniform(-0.003, 0.003, t.size)  # true, uneven times
    x = simulate(bound, t, x0, u, Conditions(resolution=NOWHERE)).x
    expected = reference_rk4(bound, t, x0, u)
    np.testing.assert_allclose(x, expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("which", ["bound", "literal"])
def test_jacobians_are_the_slopes_of_the_rates(which, request):
    """Central differences in 40 digits with step 1e-12 leave 1e-20; the tolerance is that of double precision."""
    bound = request.getfixturevalue(which)
    model, random = bound.model, np.random.default_rng(2)
    x, u = np.array([380.0, -0.4, 0.7, 240.0, 0.3, -1.1]), np.array([5.2, 1.7])
    groups = {"A": (model.states, x), "B": (model.inputs, u), "D_p": (model.parameter_symbols, bound.p)}
    signs = random.choice([-1.0, 1.0], 2)
    everything = [TIME, *model.states, *model.inputs, *model.parameter_symbols, *model.friction_signs]
    function = sympy.lambdify(everything, list(model.state_rates()), modules="mpmath")
    with mpmath.workdps(40):
        values = [mpmath.mpf(float(v)) for v in (0.0, *x, *u, *bound.p, *signs)]
        for name, (symbols, _) in groups.items():
            found = getattr(reference(model), name)(0.0, x, u, bound.p, signs)
            for column, symbol in enumerate(symbols):
                place, h = everything.index(symbol), mpmath.mpf("1e-12")
                ends = [function(*values[:place], values[place] + s * h, *values[place + 1 :]) for s in (1, -1)]
                slope = np.array([float((a - b) / (2 * h)) for a, b in zip(*ends, strict=True)])
                np.testing.assert_allclose(
                    found[:, column], slope, rtol=1e-10, atol=1e-12 * np.abs(slope).max() + 1e-13
                )


def test_one_step_per_sample_errs_by_less_than_1e_7_rad_over_the_whole_flight(bound, table):
    """Against 100 times finer steps, in a smooth closed loop, through sticking, breaking away and take-off from the stop."""
    manoeuvre = flight(bound)
    runs = [
        simulate(
            bound,
            manoeuvre.t_s,
            manoeuvre.x0,
            table,
            Conditions(reference=manoeuvre.reference_rad, resolution=NOWHERE, substeps=n),
        ).x
        for n in (1, 100)
    ]
    assert np.max(np.abs(runs[0] - runs[1])[:, [1, 4]]) < 1e-7
    stuck = np.mean(runs[0][:, [2, 5]] == 0.0, axis=0)
    assert np.all(stuck > 0.02)


def test_replayed_pieces_of_a_quantised_flight_err_by_less_than_1e_7_rad(bound, table):
    """One second each from the true states, inputs as flown with the encoders' steps in the loop: many stops and reversals."""
    manoeuvre = flight(bound)
    flown = simulate(bound, manoeuvre.t_s, manoeuvre.x0, table, Conditions(reference=manoeuvre.reference_rad))
    starts = np.arange(0, flown.t_s.size - 101, 100)
    u = np.stack([flown.u[k : k + 101] for k in starts])
    runs = [
        simulate(bound, np.arange(101) * 0.01, flown.x[starts], u, Conditions(resolution=NOWHERE, substeps=n)).x
        for n in (1, 100)
    ]
    assert np.max(np.abs(runs[0] - runs[1])[:, :, [1, 4]]) < 1e-7


def test_the_step_halving_check_reports_the_error_that_there_is(bound, table):
    """Richardson's estimate from n and 2 n steps against the true error from 100 n, within a factor of 2."""
    manoeuvre = hop(bound)
    arguments = (bound, manoeuvre.t_s, manoeuvre.x0, table)
    report = step_error(*arguments, reference=manoeuvre.reference_rad)
    runs = [
        simulate(*arguments, Conditions(reference=manoeuvre.reference_rad, resolution=NOWHERE, substeps=n)).y
        for n in (1, 100)
    ]
    true = np.max(np.abs(runs[0] - runs[1]), axis=0)
    assert np.all(report.estimate > true / 2)
    assert np.all(report.estimate < true * 2)
    assert np.all(report.estimate < 1e-7)


@pytest.mark.parametrize("substeps", [1, 3])
def test_batched_and_single_closed_loops_are_the_same_bits(bound, table, substeps):
    random, manoeuvre = np.random.default_rng(3), hop(bound)
    p = bound.p + bound.sd * random.normal(size=(21, bound.p.size))
    noise = Noise(7, measurement_sd=[1e-4, 1e-4], process_sd=[0.5, 0, 1e-3, 0.5, 0, 1e-3])
    x0 = manoeuvre.x0 + [0, 1, 0, 0, 1, 0] * random.normal(size=(21, 1)) * 0.02
    under = Conditions(reference=manoeuvre.reference_rad, p=p, noise=noise, substeps=substeps)
    one, many = (run_equations(bound, manoeuvre.t_s, x0, table, under, batched=batched) for batched in (False, True))
    for name in "uyx":
        assert np.array_equal(getattr(one, name), getattr(many, name))
    assert np.all(np.isfinite(many.x))
    assert np.ptp(many.x[:, -1, 0]) > 0.0


def test_outputs_are_whole_encoder_steps_and_inputs_stay_in_range(bound, table):
    manoeuvre = hop(bound)
    runs = simulate(bound, manoeuvre.t_s, manoeuvre.x0, table, Conditions(reference=manoeuvre.reference_rad))
    step = bound.plant.sensors["psi_rad"]
    counts = runs.y / step
    assert np.max(np.abs(counts - np.round(counts))) < 1e-9
    assert np.max(np.abs(runs.y - runs.x[:, [1, 4]])) <= step / 2 * (1 + 1e-12)


def test_an_input_beyond_its_limits_acts_as_the_limit(bound):
    t, x0, _ = excited(bound, 0.2)
    far, limit = (np.broadcast_to(u, (t.size, 2)).copy() for u in ([99.0, -99.0], [10.0, -10.0]))
    assert np.array_equal(simulate(bound, t, x0, far).x, simulate(bound, t, x0, limit).x)


def test_a_controller_in_c_may_close_the_loop(bound):
    """A proportional law behind a function pointer gives what its own inputs give when replayed."""
    text = (
        "void law(void *k, const double *r, const double *y, double *u)"
        "{ u[0] = 5.0 + *(const double *)k * (r[0] - y[0]); u[1] = 1.8; }"
    )
    path = build_shared("proportional", [CText("law.c", text)], flags=STRICT_FLOAT_FLAGS)
    ffi, lib = load_shared("void law(void *, const double *, const double *, double *);", path)
    gain, manoeuvre = ffi.new("double *", 2.5), hop(bound)
    address = [int(ffi.cast("uintptr_t", pointer)) for pointer in (ffi.addressof(lib, "law"), gain)]
    flown = simulate(
        bound, manoeuvre.t_s, manoeuvre.x0, CController(*address), Conditions(reference=manoeuvre.reference_rad)
    )
    np.testing.assert_array_equal(flown.u[:, 0], 5.0 + 2.5 * (manoeuvre.reference_rad[:, 0] - flown.y[:, 0]))
    assert np.array_equal(simulate(bound, manoeuvre.t_s, manoeuvre.x0, flown.u).x, flown.x)


def test_noise_is_repeatable_normal_and_of_the_stated_size(bound):
    t, x0, u = excited(bound, 20.0)
    options = {"resolution": NOWHERE, "locked": ("elevation", "azimuth")}
    first, again, other = (
        simulate(bound, t, x0, u, Conditions(noise=Noise(seed, measurement_sd=[0.01, 0.02]), **options)).y
        for seed in (1, 1, 2)
    )
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
    errors = (first - [x0[1], x0[4]]) / [0.01, 0.02]
    assert abs(errors.mean()) < 4 / np.sqrt(errors.size)
    assert abs(errors.std() - 1.0) < 4 / np.sqrt(2 * errors.size)
    assert abs(np.corrcoef(errors.T)[0, 1]) < 4 / np.sqrt(len(errors))


def test_a_model_with_every_kind_of_expression_compiles_to_what_it_says(mechanism):
    """Effects will bring case distinctions, steps, exponentials and the time: the kernel against SymPy's own numbers."""
    plain = mechanism()
    s, v = plain.model.states
    terms = [
        sympy.Piecewise((s, s > 0.1), (-v, (v < 0.2) & (s < 0)), (sympy.exp(s), True)),
        sympy.Min(s, v, 0.3) + sympy.Max(v, -s) + sympy.Heaviside(s - 0.05) + sympy.sign(v) * sympy.Abs(s),
        sympy.tanh(3 * v) + sympy.sqrt(1 + s**2) + sympy.floor(7 * s) / 9 + sympy.Rational(1, 3) ** s,
        sympy.sin(2 * s + TIME) * sympy.cos(3 * v) + sympy.atan(s) - sympy.pi * TIME**3 / (1 + s**2) ** 2,
    ]
    axis = plain.model.axes[0]
    force = sympy.Add(*terms)
    model = replace(plain.model, axes=(replace(axis, torque=force, coulomb=sympy.Integer(0)),))
    bound = replace(plain, model=model)
    for x0 in ([0.3, 0.5], [-0.4, 0.1], [0.02, -0.7]):
        h = 1e-7
        x = simulate(bound, [0.25, 0.25 + h], x0, np.zeros((2, 1)), Conditions(resolution=[0.0])).x
        expected = float(force.subs({s: x0[0], v: x0[1], TIME: 0.25}).evalf()) / 2.0
        assert (x[1, 1] - x[0, 1]) / h == pytest.approx(expected, rel=1e-5)


USABLE = (
    sympy.atan2(V, 1 + S), sympy.Mod(3 * S + V, sympy.Rational(2, 5)), sympy.asinh(V), sympy.acosh(2 + S), sympy.atanh(S / 2),
    sympy.erf(S), sympy.erfc(V), sympy.ceiling(3 * V), sympy.sinh(S) * sympy.cosh(V), sympy.tan(S), sympy.asin(S / 2),
)  # fmt: skip


def test_what_a_file_may_use_runs_side_by_side_as_alone(mechanism):
    # Truth: SymPy's own number for one run, to 1e-5; the same bits for sixteen at once. Each is the rate of a state of its own.
    plain = mechanism()
    s, v = plain.model.states
    at = {s: 0.3, v: 0.5}
    rates = {symbol(f"z_{k}"): f.subs({S: s, V: v}) for k, f in enumerate(USABLE)}
    model = replace(plain.model, states=(*at, *rates), rates={**plain.model.rates, **rates})
    bound = replace(plain, model=model)
    t_s, x0, u = [0.0, 1e-7], [*at.values(), *np.zeros(len(rates))], np.zeros((2, 1))
    alone = simulate(bound, t_s, x0, u, Conditions(resolution=[0.0])).x
    side_by_side = simulate(bound, t_s, x0, u, Conditions(p=np.tile(bound.p, (16, 1)), resolution=[0.0])).x
    for k, (found, rate) in enumerate(zip(alone[1, 2:] / 1e-7, rates.values(), strict=True)):
        assert found == pytest.approx(float(rate.subs(at).evalf()), rel=1e-5), USABLE[k]
    assert np.array_equal(side_by_side, np.tile(alone, (16, 1, 1)))


def test_a_held_axis_may_have_other_friction_up_than_down(mechanism):
    """A Coulomb level that depends on the friction's direction: 0.5 N upwards, 0.2 N downwards."""
    plain = mechanism()
    axis: Axis = plain.model.axes[0]
    sign = plain.model.friction_signs[0]
    lopsided = replace(axis, coulomb=sympy.Float(0.35) + sympy.Float(0.15) * sign)
    bound = replace(plain, model=replace(plain.model, axes=(lopsided,)))
    for force, moves in ((0.49, False), (0.51, True), (-0.19, False), (-0.21, True)):
        x = simulate(bound, [0.0, 1.0], [0.0, 0.0], np.full((2, 1), force), Conditions(resolution=[0.0])).x
        assert bool(x[1, 0] != 0.0) is moves


def test_the_header_is_the_same_text_each_time(bound):
    assert model_header(bound.model) == model_header(bound.model)


def test_plants_of_the_same_equations_share_what_is_compiled(mechanism, monkeypatch):
    own = mechanism().model
    kernel(own)
    monkeypatch.setattr(host, "run_zig", lambda *_: pytest.fail("compiled again"))
    kernel(replace(own, name="another"))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"x0": [0.0, 1.0]}, r"x0: got shape \(2,\), expected shape \(1, 6\)"),
        ({"drive": np.zeros((5, 2))}, r"u: got shape \(5, 2\), expected shape \(101, 2\)"),
        ({"x0": [np.nan, 0, 0, 0, 0, 0]}, "x0: got a number that is not finite"),
        ({"drive": CController(0)}, "reference: got nothing, expected references for the controller"),
    ],
)
def test_arguments_that_do_not_fit_are_refused_by_name(bound, change, message):
    t, x0, u = excited(bound)
    arguments = {"x0": x0, "drive": u} | change
    with pytest.raises(BadInput, match=message):
        simulate(bound, t, **arguments)
