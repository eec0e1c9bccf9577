"""Tables of one to four loops, of one to five states, with a schedule by any of their angles or none: one law in every form."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from codegen.fixed.twin import FixedTwin
from codegen.law import generate_law
from codegen.twin import Float32Twin
from design.law import FloatLaw
from records.errors import BadInput
from records.loops import Loop
from records.table import AxisLaw, ControllerTable, Schedule, load_table, table_text
from tests.soak import SOAK, sampled
from verification.equality import compare
from verification.fixed_stimuli import fixed_stimuli
from verification.host_law import HostLaw, host_law
from verification.stimuli import standard_stimuli

STEPS = 4_000 if SOAK else 1_500
TWINS = {"float32": Float32Twin, "fixed": FixedTwin}
STIMULI = {"float32": standard_stimuli, "fixed": fixed_stimuli}
NAMES = ("arm", "yaw", "tilt", "wrist")


@cache
def any_table(orders: tuple[int, ...], scheduled: int | None, roll_off: bool = True) -> ControllerTable:
    """Coefficients of ordinary size, none of which flies anything; `scheduled` is the place of the scheduling loop."""
    rng = np.random.default_rng(sum(orders))
    loops = tuple(Loop(name, f"{name}_rad", f"u_{name}_V", name) for name in NAMES[: len(orders)])
    if len(loops) == 1:
        loops = (Loop("arm", "theta_rad", "u_V", "arm"),)
    degree = 0 if scheduled is None else 2
    return ControllerTable(
        plant="any",
        sample_period_s=0.01,
        schedule=None if scheduled is None else Schedule(loops[scheduled].axis, -0.5, 0.8),
        axes=tuple(_law(order, degree, roll_off, rng) for order in orders),
        loops=loops,
    )


def _law(order: int, degree: int, roll_off: bool, rng: np.random.Generator) -> AxisLaw:
    def polynomial(scale: float) -> tuple[float, ...]:
        return (scale, *(float(c) for c in scale * rng.uniform(-0.3, 0.3, degree)))

    return AxisLaw(
        q_V_rad=tuple(polynomial(2.0 * 3.0**power) for power in range(order + 1)),
        p=tuple(polynomial(0.1 if power == 0 else 0.9 / 2.0**power) for power in range(order + roll_off)),
        a=tuple(0.5 / 2.0**power for power in range(order)),
        feedforward_V=polynomial(1.0),
        prefilter_time_constant_s=0.2,
        u_min_V=-5.0,
        u_max_V=5.0,
        u_safe_V=0.0,
        reference_min_rad=-0.6,
        reference_max_rad=0.9,
        resolution_rad=2.0 * np.pi / 4096.0,
    )


SHAPES = [((1,), None), ((2,), 0), ((5,), None), ((3, 2), 1), ((2, 1, 4, 3), 2)]


EACH = [(*shape, arithmetic) for shape in SHAPES for arithmetic in TWINS]


@pytest.mark.parametrize(("orders", "scheduled", "arithmetic"), sampled(EACH, keep=[EACH[n] for n in (0, 3, 8)]))
def test_twin_and_host_are_equal_bit_for_bit_and_the_self_test_finds_nothing(
    orders: tuple[int, ...], scheduled: int | None, arithmetic: str
) -> None:
    table = any_table(orders, scheduled)
    twin, host = TWINS[arithmetic](table), host_law(table, arithmetic)
    result = compare(twin, host, STIMULI[arithmetic](table, STEPS), table.loops)
    assert result.equality.steps >= STEPS
    assert result.equality.mismatches == 0, result.first_mismatch
    assert host.self_test() == 0
    assert host.table_digest() == table.digest


SYMBOLS = ["self", "input", "output", "powers", "clamp", "uint64_t", "sum", "c", "schedule"]


@pytest.mark.parametrize("arithmetic", TWINS)
@pytest.mark.parametrize("symbol", sampled(SYMBOLS, keep=["self", "uint64_t", "schedule"]))
def test_a_scheduling_column_may_be_called_as_anything_in_the_law(symbol: str, arithmetic: str) -> None:
    """Truth: columns are members of structs there, beside which functions, types and variables keep their names."""
    table = replace(any_table((2,), 0), loops=(Loop("arm", f"{symbol}_rad", "u_V", "arm"),))
    assert host_law(table, arithmetic).self_test() == 0


@pytest.mark.parametrize(("orders", "scheduled"), SHAPES)
def test_the_float_law_says_the_same_to_single_precision(orders: tuple[int, ...], scheduled: int | None) -> None:
    """Truth: design.law, written apart; to 2 mV while both are driven through the same angles, which do not feed back."""
    table = any_table(orders, scheduled, roll_off=False)
    double, single = FloatLaw(table), Float32Twin(table)
    rng, loops = np.random.default_rng(3), len(orders)
    double.reset(*[0.0] * loops)
    single.reset(*[0.0] * loops)
    angles = np.cumsum(rng.uniform(-0.003, 0.003, (300, loops)), axis=0)
    references = np.repeat(rng.uniform(-0.3, 0.3, (10, loops)), 30, axis=0)
    for row in np.hstack([references, angles]).tolist():
        assert single.step(*row) == pytest.approx(double.step(*row), abs=2e-3)


def test_a_change_in_the_last_loop_is_noticed() -> None:
    """The check can fail: the C of another table of the same shape differs."""
    table, other = any_table((3, 2), 1), any_table((3, 2), 1, roll_off=False)
    changed = HostLaw(generate_law(other), loops=table.loops)
    assert compare(Float32Twin(table), changed, standard_stimuli(table, 500), table.loops).equality.mismatches


@pytest.mark.parametrize(("orders", "scheduled"), SHAPES)
def test_a_table_reads_back_as_itself(orders: tuple[int, ...], scheduled: int | None, tmp_path: Path) -> None:
    table = any_table(orders, scheduled)
    (tmp_path / "table.json").write_text(table_text(table))
    assert load_table(tmp_path / "table.json") == table


def test_coefficients_that_vary_without_a_schedule_are_refused() -> None:
    table = any_table((2,), 0)
    bare = ControllerTable(**{**vars(table), "schedule": None})
    with pytest.raises(BadInput, match=r"axis arm.*vary without a schedule"):
        Float32Twin(bare)
