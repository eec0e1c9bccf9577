"""How much of the processor a simulation uses: the operations of one sample, and the most that one core computes."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import sympy

from sim.bench.compiled_peers import sample_step
from sim.bench.peers import Task
from sim.bench.plain_law import LAW_STATES
from sim.kernel.kernel import BATCH_LANES
from toolchain.host import FAST_FLAGS, CText, build_shared, load_shared

# Sums and products of a sine and its cosine in sim/kernel/c/sincos.h; a sample that needs both is given half to each.
SINCOS_OPERATIONS = 37
ROUNDS, TRIES = 1_000_000, 9  # the best of them counts, as for every tool
# More chains than the latency of an operation times those that begin in a cycle, so that none waits for another.
_CHAINS = 12
_PEAK = f"""
typedef double num __attribute__((vector_size(8 * {BATCH_LANES})));
double peak_run(long rounds);
double peak_run(long rounds)
{{
    num a[{_CHAINS}];
    for (int i = 0; i < {_CHAINS}; i++)
        a[i] = (num){{}} + 1.0 + i;
    for (long round = 0; round < rounds; round++)
        _Pragma("clang loop unroll(full)") for (int i = 0; i < {_CHAINS}; i++)
            a[i] = a[i] * 0.999 + 0.001;
    num sum = {{}};
    for (int i = 0; i < {_CHAINS}; i++)
        sum += a[i];
    return sum[0];
}}
"""


@dataclass(frozen=True)
class ProcessorShare:
    """Double-precision operations of one sample, the most that a core does in a second, and the part of it that the kernel reaches."""

    operations: int
    peak_per_s: float
    single: float
    side_by_side: float


@dataclass
class _Tally:
    operations: int = 0


@dataclass(frozen=True)
class _Counted:
    """A number without a value that counts what is done to it."""

    tally: _Tally = field(default_factory=_Tally)

    def _counted(self, *_: object) -> "_Counted":
        self.tally.operations += 1
        return self

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __rtruediv__ = __pow__ = _counted

    def __neg__(self) -> "_Counted":
        return self

    __abs__ = __neg__


def operations(task: Task) -> int:
    """Sums, products, quotients and comparisons of one sample as every tool computes it: encoders, law, a Runge-Kutta step."""
    number = _Counted()

    def one(a: Any, b: Any = None) -> _Counted:
        return number._counted()

    def wave(a: Any) -> _Counted:
        number.tally.operations += SINCOS_OPERATIONS // 2
        return number

    class Ops:
        minimum, maximum, floor = one, one, one

    sign = sympy.Function("sign_of")  # SymPy would write its own with Python's numbers
    names: dict[str, Callable[..., Any]] = {"sin": wave, "cos": wave, "sign_of": one}
    model = task.bound.model
    arguments = [*model.states, *model.inputs, *model.parameter_symbols, *model.friction_signs]
    expressions = tuple(rate.replace(sympy.sign, sign) for rate in model.state_rates())
    rates = sympy.lambdify(arguments, expressions, modules=[names], cse=True)
    known = [number] * (len(model.parameter_symbols) + len(model.friction_signs))
    step = sample_step(task, Ops, lambda *given: rates(*given, *known))
    step([number] * len(model.states), [number] * (2 * LAW_STATES), [number] * 2)
    return number.tally.operations


def peak_per_s() -> float:
    """Sums and products, as many of each, that one core computes in a second of its time, as wide as the kernel; measured."""
    library = load_shared(
        "double peak_run(long rounds);", build_shared("peak", [CText("peak.c", _PEAK)], flags=FAST_FLAGS)
    )[1]
    spent_s = []
    for _ in range(TRIES):
        begin = time.process_time()
        library.peak_run(ROUNDS)
        spent_s.append(time.process_time() - begin)
    return 2.0 * _CHAINS * BATCH_LANES * ROUNDS / max(min(spent_s), 1e-9)


def share(task: Task, single_s_per_s: float, batch_s_per_s: float) -> ProcessorShare:
    """What of the peak the kernel reaches that simulates so many seconds in one, a run at a time and side by side."""
    count, peak = operations(task), peak_per_s()
    single, batch = (count * speed / task.period_s / peak for speed in (single_s_per_s, batch_s_per_s))
    return ProcessorShare(count, peak, single, batch)
