"""The language of a mapping: what it reads, what it refuses, and that nothing of it is ever run."""

import numpy as np
import pytest

from recordings.mapping.evaluation import BadExpression, Quantity, Reference, evaluate
from recordings.mapping.expression import parse

X = np.array([1.0, 2.0, 4.0])


def _value(text: str, unit: str = "", names: tuple[str, ...] = ()) -> Quantity:
    """The expression with every reference being X."""
    return evaluate(parse(text, names), lambda reference: Quantity(X, unit), lambda unit: 360.0)


def _asked(text: str, names: tuple[str, ...]) -> list[Reference]:
    """What the expression looks up, from left to right."""
    asked: list[Reference] = []

    def look_up(reference: Reference) -> Quantity:
        asked.append(reference)
        return Quantity(X, "")

    evaluate(parse(text, names), look_up, lambda unit: 360.0)
    return asked


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("x*pi/180", X * np.pi / 180.0),
        ("-(x + 1)^2", -((X + 1.0) ** 2)),
        ("x.*2./4", X / 2.0),
        ("2**x - +1", 2.0**X - 1.0),
        ("atan2(x, 2*x)", np.full(3, np.arctan2(1.0, 2.0))),
        ("min(x, 2)", np.minimum(X, 2.0)),
        ("radians(x)", np.radians(X)),
        ("Psi [deg]*2", 2.0 * X),
        ("'any thing'*2", 2.0 * X),
    ],
)
def test_arithmetic_is_that_of_numpy(text: str, values: np.ndarray) -> None:
    np.testing.assert_allclose(_value(text, names=("Psi [deg]",)).values, values, rtol=1e-15)


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("run.psi", Reference("run.psi")),
        ("NAME.signals.values(:,2)", Reference("NAME.signals.values(:,2)", "NAME.signals.values", (None, 1))),
        ("Scope.signals(2).values", Reference("Scope.signals(2).values")),
        ("ans(3,:)", Reference("ans(3,:)", "ans", (2, None))),
        ("q[1]", Reference("q[1]", "q", (None, 1))),
        ("M[:,0]", Reference("M[:,0]", "M", (None, 0))),
        ("a*b", Reference("a*b")),
        ("/rig/joint.position[0]", Reference("/rig/joint.position[0]")),
        (r"psi\XCP:1", Reference(r"psi\XCP:1")),
    ],
)
def test_a_name_is_what_the_file_has_and_a_pick_counts_from_one_in_round_brackets(text: str, meant: Reference) -> None:
    names = ("a*b", "/rig/joint.position[0]", r"psi\XCP:1")
    assert _asked(text, names) == [meant]
    assert _asked(f"2*{text} + 1", names) == [meant]


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        *[("x", "deg"), ("-x", "deg"), ("-1*x", "deg"), ("x/-1", "deg"), ("x + 3", "deg"), ("unwrap(x)", "deg")],
        *[("x*2", None), ("1/x", None), ("sin(x)", None), ("x*pi/180", None), ("3", "")],
    ],
)
def test_a_unit_passes_a_sign_and_a_sum_and_a_factor_is_the_users_own(text: str, unit: str | None) -> None:
    assert _value(text, "deg").unit == unit


@pytest.mark.parametrize(
    "text", ["x*0", "0*x", "x/0", "0/x", "x*(1-1)", "x/(2-2)", "x*nan", "x*1e999", "x+1/0", "max(x, nan)"]
)
def test_a_factor_that_is_zero_or_no_number_is_refused(text: str) -> None:
    with pytest.raises(BadExpression):
        parse(text)


@pytest.mark.parametrize(
    "text",
    [
        *["", "x*", "x*0,5", "__import__('os').system('id')", "lambda: 0", "x if x else y", "[x for x in y]", "x == y", "x; y", "x # y"],
        *["f(x)", "abs()", "abs(x, y)", "x(:,0)", "x(:,y)", "x(:,1.5)", "x*True", "1j*x", "(x := 3)", "f'{x}'", "{x}", "x and y"],
        *["9**9**9**9", "-" * 300 + "x", "x+" * 400 + "x", "1" * 450 + "*x", "x\x00"],
    ],
)  # fmt: skip
def test_anything_else_is_refused_and_nothing_is_run(text: str) -> None:
    with pytest.raises(BadExpression):
        parse(text)


def test_a_heading_that_is_a_number_takes_no_numbers_place() -> None:
    assert _asked("x*2", ("x", "2")) == [Reference("x")]
    assert _asked("'2'*2", ("x", "2")) == [Reference("2")]


def test_units_and_lengths_that_differ_do_not_add() -> None:
    units = {"a": "deg", "b": "rad"}
    with pytest.raises(BadExpression, match="deg and rad in one sum"):
        evaluate(parse("a + b"), lambda name: Quantity(X, units[name.text]), lambda unit: 1.0)
    with pytest.raises(BadExpression, match="samples in one expression"):
        evaluate(parse("a*b"), lambda name: Quantity(X if name.text == "a" else X[:2]), lambda unit: 1.0)
