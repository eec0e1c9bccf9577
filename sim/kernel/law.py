"""A controller table in the form that the kernels' own float64 law takes (sim/kernel/c/law.h)."""

from typing import Any

from records.errors import BadInput
from records.loops import LOOPS
from records.table import AxisLaw, ControllerTable, Polynomial
from sim.kernel.kernel import Kernel

MAX_COEFFICIENTS = 12  # as in sim/kernel/c/law_table.h
ORDER = 3  # states of an axis
NO_ROLL_OFF: Polynomial = ()  # p_3 of an axis without


def is_kernel_s(table: ControllerTable) -> bool:
    """Whether the kernels' own law can fly a table: both loops of a helicopter, three states each, scheduled by the first."""
    schedule = table.schedule
    return (
        table.loops == LOOPS
        and schedule is not None
        and schedule.axis == LOOPS[0].axis
        and all(axis.order == ORDER for axis in table.axes)
    )


def law_struct(kernel: Kernel, table: ControllerTable) -> Any:
    """The C struct `law_table`; raises BadInput when a polynomial has more coefficients than it has room for, or for other loops."""
    axes, schedule = table.axes, table.schedule
    if schedule is None or not is_kernel_s(table):
        names = ", ".join(loop.axis for loop in table.loops)
        raise BadInput(
            "controller table", kernel.model.name, f"loops {names} of up to {table.order} states",
            f"the helicopter's two of {ORDER}, which the kernel's own law has", "fly it as generated, or by its float law",
        )  # fmt: skip
    result = kernel.ffi.new("law_table *")
    rows = [row for axis in axes for row in (*axis.q_V_rad, *(*axis.p, NO_ROLL_OFF)[:4])]
    result.coefficients = _checked(max(len(row) for row in rows))
    result.feedforward_coefficients = _checked(max(len(axis.feedforward_V) for axis in axes))
    result.psi_min_rad, result.psi_max_rad = schedule.min_rad, schedule.max_rad
    for column, row in enumerate(rows):
        for power, coefficient in enumerate(row):
            result.scheduled[power][column] = coefficient
    for place, axis in enumerate(axes):
        _fill(result.axis[place], axis, table.sample_period_s)
    return result


def _fill(struct: Any, axis: AxisLaw, sample_period_s: float) -> None:
    struct.prefilter_gain = axis.prefilter_gain(sample_period_s)
    for index, value in enumerate(axis.a):
        struct.a[index] = value
    for index, value in enumerate(axis.feedforward_V):
        struct.feedforward_V[index] = value
    for name in ("u_min_V", "u_max_V", "u_safe_V", "reference_min_rad", "reference_max_rad"):
        setattr(struct, name, getattr(axis, name))


def _checked(count: int) -> int:
    if count > MAX_COEFFICIENTS:
        raise BadInput(
            "polynomial",
            "controller table",
            f"{count} coefficients",
            f"at most {MAX_COEFFICIENTS}",
            "design it again with a lower degree",
        )
    return count
