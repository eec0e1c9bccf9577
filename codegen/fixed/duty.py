"""Voltage words to PWM ticks in whole numbers: what the generated C does, and how its factor and shift come about."""

import math
from dataclasses import dataclass

from codegen.fixed.arithmetic import Scalars
from codegen.fixed.constants import word_number
from codegen.fixed.formats import MISSING
from codegen.fixed.polynomials import WORD_BITS
from codegen.twin import PWM_TICKS

# Of a voltage whose ticks are no whole number a volt, and of their factor: each rounds full scale by a twentieth of a tick.
_COARSE_BITS, _FACTOR_BITS = 16, 15


@dataclass(frozen=True)
class DutyFormat:
    """Ticks = (|word| / 2^coarse) factor / 2^shift, to the nearest, of a word held within +-full."""

    full: int
    coarse: int
    factor: int
    shift: int

    @property
    def half(self) -> int:
        """What rounds to the nearest."""
        return 1 << self.shift - 1


def duty_format(full_scale_V: float, voltage_places: int) -> DutyFormat:
    """That of PWM_TICKS at a full scale, for words of `voltage_places`: exact where a volt is whole ticks; sums fit 32 bits unsigned."""
    full = min(word_number(full_scale_V, voltage_places), 2**WORD_BITS - 1)
    exact = _exact(full, full_scale_V, voltage_places)
    return _coarse(full, full_scale_V, voltage_places) if exact is None else exact


def duty(word: int, safe: int, form: DutyFormat) -> int:
    """Ticks, PWM_TICKS at full scale, to the nearest, halves away from zero; MISSING gives the safe value's."""
    u = word - 2**32 if word >= 2**31 else word
    applied = Scalars().clamp(safe if u == MISSING else u, -form.full, form.full)
    ticks = ((abs(applied) >> form.coarse) * form.factor + form.half) >> form.shift
    return ticks if applied >= 0 else -ticks


def _exact(full: int, full_scale_V: float, voltage_places: int) -> DutyFormat | None:
    ratio, shift = PWM_TICKS / full_scale_V, voltage_places
    if ratio != int(ratio):
        return None
    factor = int(ratio)
    while factor % 2 == 0 and shift > 1:
        factor, shift = factor // 2, shift - 1
    form = DutyFormat(full, 0, factor, shift)
    return form if full * factor + form.half < 2**32 else None


def _coarse(full: int, full_scale_V: float, voltage_places: int) -> DutyFormat:
    coarse = max(0, full.bit_length() - _COARSE_BITS)
    fraction, exponent = math.frexp(PWM_TICKS / (full_scale_V * 2.0 ** (voltage_places - coarse)))
    return DutyFormat(full, coarse, round(math.ldexp(fraction, _FACTOR_BITS)), _FACTOR_BITS - exponent)
