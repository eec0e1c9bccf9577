"""Mutants of the Python twin and of the controller table, judged by what the law does against the compiled C.

A mutant of the twin is noticed when its steps, or the self-test that it would record, are not those of the C, or when it stops.
A mutant of the table is noticed when the twin made from it does not step as the C of the table does.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from codegen.law_frame import without_vanishing_powers
from codegen.self_test import self_test
from records.table import AxisLaw, ControllerTable, Polynomial, changed_axis
from verification.equality import BatchStepper
from verification.proofs.mutation.judge import Behaviour, stepped
from verification.proofs.mutation.mutants_python import PythonMutant, mutated_twin
from verification.stimuli import Stimulus

Facts = tuple[object, ...]
_ANGLES = [(0, 0), (1, -1), (7, 9), (-511, 403), (1024, 1365), (2**31 - 1, -(2**31))]
_VOLTAGES = (math.nan, 0.0, 5.0, -5.0, 0.0015625, -0.0015625, 10.0, -10.0, 1e4, -1e4)


@dataclass(frozen=True)
class Truth:
    """Stimuli, and what the sound law does on them."""

    stimuli: Sequence[Stimulus]
    behaviour: Behaviour


@dataclass(frozen=True)
class TableMutant:
    """A table with one change: the axis it is of, and what is changed."""

    place: str
    change: str
    table: ControllerTable

    def __str__(self) -> str:
        return f"{self.place}.{self.change}"


def is_twin_noticed(
    table: ControllerTable, arithmetic: str, mutant: PythonMutant, facts: Facts, truths: Sequence[Truth]
) -> bool:
    """Whether the twin with this change is told by the `facts` of the unchanged one, or from the C by one of the `truths`."""
    try:
        twin = mutated_twin(arithmetic, mutant)(table)
        return twin_facts(twin, table) != facts or is_table_noticed(twin, truths)
    except Exception:  # a twin that stops, for whatever reason, is noticed
        return True


def twin_facts(twin: Any, table: ControllerTable) -> Facts:
    """What a twin says before it was reset, what it records for the self-test, its angles and its duties."""
    loops = range(len(table.loops))
    fresh = twin.step(*[0.1] * len(loops), *[0.0] * len(loops))
    angles = tuple(float(twin.angle_from_counts(loop, count)) for pair in _ANGLES for count in pair for loop in loops)
    duties = tuple(twin.duty(loop, u_V) for u_V in _VOLTAGES for loop in loops)
    return fresh, self_test(table, twin), angles, duties


def table_mutants(table: ControllerTable) -> Iterator[TableMutant]:
    """A flipped ulp, a dropped sign and a swap with the next row, one at a time, for each coefficient; limits by an ulp."""
    for loop, axis in zip(table.loops, table.axes, strict=True):
        for change, changed in _axis_mutants(axis):
            yield TableMutant(loop.axis, change, changed_axis(table, loop.axis, **vars(changed)))


def is_table_noticed(twin: BatchStepper, truths: Sequence[Truth]) -> bool:
    """Whether the twin of a changed table steps otherwise."""
    return any(truth.behaviour.differs(stepped(twin, truth.stimuli)) for truth in truths)


def _axis_mutants(axis: AxisLaw) -> Iterator[tuple[str, AxisLaw]]:
    for group in ("q_V_rad", "p"):
        rows: tuple[Polynomial, ...] = getattr(axis, group)
        for index, row in enumerate(rows):
            for change, changed in _polynomial_mutants(row):
                yield f"{group}[{index}]{change}", _with(axis, group, (*rows[:index], changed, *rows[index + 1 :]))
        for index in range(len(rows) - 1):
            if rows[index] != rows[index + 1]:
                swapped = (*rows[:index], rows[index + 1], rows[index], *rows[index + 2 :])
                yield f"{group}: rows {index} and {index + 1} swapped", _with(axis, group, swapped)
    for change, changed in _polynomial_mutants(axis.feedforward_V):
        yield f"feedforward_V{change}", _with(axis, "feedforward_V", changed)
    for index, value in enumerate(axis.a):
        changed_a = (*axis.a[:index], _next(value, value), *axis.a[index + 1 :])
        yield f"a[{index}] an ulp up", _with(axis, "a", changed_a)
    for name in ("u_max_V", "reference_min_rad", "reference_max_rad", "prefilter_time_constant_s"):
        value = getattr(axis, name)
        yield f"{name} up by 2^-20", _with(axis, name, value * (1.0 + 2.0**-20))


def _with(axis: AxisLaw, name: str, value: Any) -> AxisLaw:
    changed: AxisLaw = replace(axis, **{name: value})
    return changed


def _polynomial_mutants(row: Polynomial) -> Iterator[tuple[str, Polynomial]]:
    """An ulp is one of the row's largest coefficient: in that the value of the polynomial is rounded."""
    used = without_vanishing_powers(row)
    largest = max((abs(value) for value in used), default=0.0)
    for power, value in enumerate(used):
        if np.float32(value) == 0.0:
            continue
        for change, changed in (("an ulp up", _next(value, largest)), ("its sign dropped", -value)):
            yield f"[{power}] {change}", (*row[:power], changed, *row[power + 1 :])


def _next(value: float, scale: float) -> float:
    return value + float(np.spacing(np.float32(scale)))
