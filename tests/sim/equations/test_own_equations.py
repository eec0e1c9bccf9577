"""Equations of one's own: a file beside the plant file, every slip of which is told with its line."""

from pathlib import Path

import numpy as np
import pytest

from jobs.job import canonical
from records.errors import BadInput
from records.plant import Equations, load_plant, plant_digest, save_plant
from sim.added_effects import combined, library
from sim.bind import bind
from sim.equations import nominal_model
from sim.equations.check import RULES
from sim.manoeuvres import stir
from sim.plants import MODELS
from sim.simulate import Conditions, simulate
from tests.own_plants import HEATER, PLAIN, REFUSED, TANKS, WHEEL

NAME = "my_plain"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The two files of a plain arm, in a folder that no module path knows."""
    PLAIN.write(tmp_path / "anywhere", NAME)
    return tmp_path / "anywhere"


def edited(folder: Path, old: str, new: str) -> str:
    """One text of the equations replaced; the line on which it stands."""
    path = folder / f"{NAME}.py"
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    return f"line {text[: text.index(old)].count(chr(10)) + 1}"


SLIPS = {
    "a slip of syntax": ("return Model(", "return Model((", "no Python"),
    "an unknown name": ('p["K"] * u', 'p["K"] * v', "NameError"),
    "an unknown parameter": ('p["K"] * u', 'p["KK"] * u', "give it a ParameterSpec, or correct the name"),
    "an exception while the model is made": ('p["K"] * u', "1 / 0 * u", "ZeroDivisionError"),
    "a module that is not there": ("import sympy", "import sympy, my_constants", "must be installed, or stand in it"),
    "an end of the program": ("import sympy", "import sympy; raise SystemExit(3)", "SystemExit: 3"),
    "a choice by Python": ('p["K"] * u', 'p["K"] * (u if u > 0 else 0)', "sympy.Piecewise for a choice"),
    "a sine of math": ('p["K"] * u', 'p["K"] * __import__("math").sin(u)', "take sympy's sin"),
    "a sine of NumPy": ('p["K"] * u', 'p["K"] * __import__("numpy").sin(u)', "take sympy's sin"),
    "one symbol instead of a tuple": ("inputs=(u,)", "inputs=(u)", "inputs=(A,)"),
    "a list instead of a tuple": ("states=(theta, omega)", "states=[theta, omega]", "a tuple"),
    "a matrix where a number belongs": ("rates={theta: omega}", "rates={theta: sympy.eye(2)}", "one number or SymPy"),
    "dry friction of None": ("torque, 0, None", "torque, None, None", "0 where the axis has no dry friction"),
    "a symbol that nothing declares": ("rates={theta: omega}", 'rates={theta: symbol("w")}', "the unknown name w"),
    "a symbol that is not real": ('symbol("u_V")', 'sympy.Symbol("u_V")', 'write symbol("u_V")'),
    "a state without a rate": ("rates={theta: omega}", "rates={}", "nothing for theta_rad"),
    "a rate of an axis' velocity": ("rates={theta: omega}", "rates={theta: omega, omega: u}", "its axis alone"),
    "an output of an input": ('outputs={"theta_rad": theta}', 'outputs={"theta_rad": theta + u}', "take it out"),
    "a function that no C has": ("rates={theta: omega}", "rates={theta: sympy.zeta(omega)}", "write it with these"),
    "a function whose slope no C has": ("rates={theta: omega}", "rates={theta: sympy.gamma(2 + omega)}", "write it with these"),
    "a function of nobody's": ("{theta: omega}", '{theta: omega * sympy.Function("f")(omega)}', ", with f(omega_rad_s), expected"),
    "a quotient by nothing": ("{theta: omega}", "{theta: omega / sympy.Integer(0)}", "look for a division by 0"),
    "an imaginary rate": ("{theta: omega}", "{theta: omega + sympy.I * theta}", "take out the imaginary unit"),
    "a rate without end": ("{theta: omega}", "{theta: omega * sympy.oo}", "a real number everywhere"),
    "a position that moves by itself": ("rates={theta: omega}", "rates={theta: 1.0}", "without the velocity omega_rad_s of axis 'arm'"),
    "an axis of another velocity": ('Axis("arm", theta, omega', 'Axis("arm", theta, u', "a state: "),
    "a limit that moves": ("input_limits={u: (-10, 10)}", "input_limits={u: (-10, theta)}", "limit of u_V"),
    "a letter that no C has": ('symbol("omega_rad_s")', 'symbol("ω_rad_s")', "expected letters a to z, digits and _"),
    "a name of the kernel's": ('symbol("u_V")', 'symbol("dx")', "the compiled kernel"),
    "a parameter called as the time": ('"b"', '"t_s"', "which the equations have for the time"),
    "a state called as a function": ('symbol("omega_rad_s")', 'symbol("sin")', "'sin', which the equations have for a function"),
    "an inertia of nothing": ('p["J"], torque', "0, torque", "an inertia of 0"),
    "a keyword of Python": ('symbol("u_V")', 'symbol("lambda")', "'lambda', a keyword of Python"),
    "an output called as a column": ('outputs={"theta', 'outputs={"t_s": omega, "theta', "'t_s', a column of every log"),
    "an output called as the input": ('outputs={"theta', 'outputs={"u_V": omega, "theta', "'u_V', a column of every log"),
    "a unit that is none": ('"kg m^2"', '"stone"', "stone"),
    "a size of nothing": ('InputPlace(u, "V", 10.0)', 'InputPlace(u, "V", 0.0)', "a number above 0"),
    "another name": (f'name="{NAME}"', 'name="other"', f'write name="{NAME}"'),
    "no model": ("def model()", "def plant()", "a function model()"),
}  # fmt: skip


@pytest.mark.parametrize(("old", "new", "told"), SLIPS.values(), ids=SLIPS)
def test_a_slip_is_told_with_file_and_line(old: str, new: str, told: str, folder: Path) -> None:
    line = edited(folder, old, new)
    with pytest.raises(BadInput) as error:
        bind(load_plant(folder / "plant.toml"))
    assert told in str(error.value)
    where = error.value.where
    assert where.startswith(str(folder / f"{NAME}.py"))
    if new != "def plant()":
        # A slip inside a call may be told at the line where the call, the tuple or the keyword begins.
        assert abs(int(where.rsplit(" ", 1)[1]) - int(line.split()[1])) <= 1 or told in ("its axis alone", "no Python")


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_used_is_refused_before_anything_is_compiled(name: str, tmp_path: Path) -> None:
    plant, told = REFUSED[name]
    with pytest.raises(BadInput, match=told):
        bind(load_plant(plant.write(tmp_path, f"my_{name}")))


def test_an_axis_without_a_position_has_no_effect_that_asks_where_it_is(tmp_path: Path) -> None:
    wheel = bind(load_plant(WHEEL.write(tmp_path, "my_wheel")))
    known = library(wheel)
    assert not {"arm.cable_spring", "arm.detent", "gyro.cyclic"} & set(known)
    assert {"arm.coulomb", "arm.quadratic_drag", "gyro.scale"} <= set(known)
    for name, effect in known.items():
        if effect.on_equations and effect.repeats:
            assert combined(wheel, [name]).effects, name


@pytest.mark.parametrize("name", MODELS)
def test_the_project_s_own_models_keep_the_rules(name: str) -> None:
    slips = [slip for rule in RULES[:1] + RULES[2:] for slip in rule(MODELS[name](), Equations(f"{name}.py", ""))]
    if name == "antx_2dof_drone":  # its input M, a share of the largest torque, has no unit that a name could bear
        slips = [slip for slip in slips if slip.words != ("M",)]
    assert slips == []


@pytest.mark.parametrize("file", ["../my_arm.py", "my_arm", "my arm.py", "class.py", "/etc/passwd", ""])
def test_a_file_that_is_not_beside_is_refused(file: str, folder: Path) -> None:
    path = folder / "plant.toml"
    path.write_text(path.read_text(encoding="utf-8").replace(f"{NAME}.py", file), encoding="utf-8")
    with pytest.raises(BadInput, match="equations"):
        load_plant(path)


def test_a_missing_file_is_named(folder: Path) -> None:
    (folder / f"{NAME}.py").unlink()
    with pytest.raises(BadInput, match=f"{NAME}.py"):
        load_plant(folder / "plant.toml")


def test_the_same_text_is_the_same_model_and_another_text_another(folder: Path, tmp_path: Path) -> None:
    first, again = (load_plant(folder / "plant.toml") for _ in range(2))
    assert nominal_model(first) is nominal_model(again)
    save_plant(tmp_path / "copy" / "plant.toml", first)
    copy = load_plant(tmp_path / "copy" / "plant.toml")
    assert copy == first
    assert plant_digest(copy) == plant_digest(first)
    edited(folder, 'p["K"] * u', '2 * p["K"] * u')
    changed = load_plant(folder / "plant.toml")
    assert nominal_model(changed) is not nominal_model(first)
    assert plant_digest(changed) != plant_digest(first)
    assert canonical(changed) != canonical(first)


def test_changed_equations_move_otherwise(folder: Path) -> None:
    # Truth: J theta'' = K u at rest, so twice the K bends the start of the way twice as much: 1/2 K u / J t^2.
    def way() -> float:
        arm = bind(load_plant(folder / "plant.toml"))
        run = simulate(arm, np.array([0.0, 0.01]), [0.0, 0.0], np.ones((2, 1)), Conditions(resolution=[0.0], keep="y"))
        assert run.y is not None
        return float(run.y[-1, 0])

    before = way()
    edited(folder, 'p["K"] * u', '2 * p["K"] * u')
    assert before == pytest.approx(0.5 * 0.05 / 0.01 * 0.01**2, rel=0.02)
    assert way() == pytest.approx(2.0 * before, rel=1e-9)


def test_what_the_file_prints_is_no_answer(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    edited(folder, "import sympy", "import sympy; print('hello')")
    bind(load_plant(folder / "plant.toml"))
    told = capsys.readouterr()
    assert (told.out, told.err) == ("", "hello\n")


def test_a_stir_stays_within_the_limits_and_begins_at_rest(folder: Path) -> None:
    moved = stir(bind(load_plant(folder / "plant.toml")))
    assert np.all(np.abs(moved.u) <= 10.0)
    assert moved.u[0] == pytest.approx([0.0], abs=1e-9)
    assert moved.x0 == pytest.approx([0.0, 0.0], abs=1e-9)


def test_a_stir_of_what_does_not_move_begins_at_rest_under_half_its_input_and_lasts_as_long_as_the_plant(
    tmp_path: Path,
) -> None:
    # Truth: 30 W of 60 over 0.8 W/K is 37.5 K, in the 25 s of C / G; of the tanks the pump's half flows out under v^2 = 2 g h2.
    heated = stir(bind(load_plant(HEATER.write(tmp_path / "heater", "heater"))))
    assert heated.u[0] == pytest.approx([30.0])
    assert heated.x0 == pytest.approx([37.5])
    assert heated.t_s[-1] == pytest.approx(20.0 * 32.0)
    filled = stir(bind(load_plant(TANKS.write(tmp_path / "tanks", "tanks"))))
    assert filled.u.min() == pytest.approx(6.0 - 0.2 * 6.0)
    level_m = (5e-5 * 6.0 / 1e-4) ** 2 / (2 * 9.81)
    assert filled.x0 == pytest.approx([2 * level_m, level_m])


def test_equations_that_differ_at_each_run_are_refused(folder: Path) -> None:
    """Truth: what is proved and flown is one plant; a random number in it makes another of each run."""
    edited(folder, 'p["K"] * u', '__import__("random").random() * u')
    with pytest.raises(BadInput, match="got others at each run of the file, expected the same at every run"):
        bind(load_plant(folder / "plant.toml"))
