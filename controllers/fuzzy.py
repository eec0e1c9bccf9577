"""Mamdani fuzzy controllers of seed 001: elevation of 90 rules, azimuth of 18, max-min inference, centroid.

    mu_set(x) = min(1, max(0, min(r_0 + r_1 x, f_0 + f_1 x)))          trapezoids; a shoulder has r = (1, 0) or f = (1, 0)        (C.4)
    w_output = max over its rules of min(mu_region(r), mu_rate(d), mu_error(e))                                                (C.5)
    level(u) = max over outputs of min(w_output, mu_output(u))                                                                 (C.6)
    v = s sum_i u_i d_i level(u_i) / sum_i d_i level(u_i)              the centroid by the trapezoidal rule on the nodes u_i      (C.7)

with e the error, d its derivative from the filtered angle, r the elevation's reference, in degrees, and s the volts of one
unit. What the sets and rules are, how each was read, and which slips of the paper are mended stands in
controllers/fuzzy_sets.py. v is added to the feed-forward.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

import numpy as np

from codegen.law_frame import LawNumbers, Sample
from controllers.equations.designing import Points, axis_table, law_table
from controllers.equations.equation_controller import EquationController
from controllers.equations.frame import AxisNumbers, Decisions
from controllers.equations.tuned import Numbers, OpenNumber, Tunable, tuned
from controllers.fuzzy_sets import (
    AZIMUTH,
    ELEVATION,
    ERROR_LABELS,
    FILTER_S,
    RATE_LABELS,
    SHOULDER_FOOT,
    Trapezoid,
    Wording,
    error_sets,
)
from records.law_table import LawTable
from records.table import lag_gain

N = TypeVar("N")
Slopes = tuple[float, float, float, float]

ANGLE_MAX_RAD = 8.0
ALWAYS: Slopes = (1.0, 0.0, 1.0, 0.0)
INPUT_MAX = 1e4  # no error in deg, no rate in deg/s is larger: products with slopes stay finite


@dataclass(frozen=True)
class OutputNode:
    """One u_i of (C.7): u_i d_i, d_i, and the output sets that are not zero there with their memberships."""

    moment: float
    width: float
    sets: tuple[int, ...]
    memberships: tuple[float, ...]


@dataclass(frozen=True)
class FuzzyGains:
    """Everything of one axis: sets as slopes (r_0, r_1, f_0, f_1), rules as places (region, rate, error, output)."""

    degrees: float
    rate_scale: float
    filter_gain: float
    output_V: float
    angle_max_rad: float
    input_max: float
    one: float
    regions: tuple[Slopes, ...]
    rates: tuple[Slopes, ...]
    errors: tuple[Slopes, ...]
    outputs: int
    rules: tuple[tuple[int, int, int, int], ...]
    nodes: tuple[OutputNode, ...]


@dataclass(frozen=True)
class FuzzyState(Generic[N]):
    """What one axis remembers: filtered reference, filtered angle."""

    reference_1_rad: N
    reference_2_rad: N
    filtered_rad: N


class Fuzzy:
    """The equations of one axis, name by name and operation by operation as in templates/fuzzy.c.j2."""

    AxisState = FuzzyState

    def axis_rest(
        self,
        law: LawNumbers[N],
        axis: AxisNumbers[N],
        arithmetic: Decisions[N],
        reference_rad: N,
        angle_rad: N,
        schedule_rad: N,
    ) -> FuzzyState[N]:
        """The filters at the angle."""
        filtered_rad = arithmetic.clamp(angle_rad, -axis.gains.angle_max_rad, axis.gains.angle_max_rad)
        return FuzzyState(reference_rad, reference_rad, filtered_rad)

    def axis_step(
        self,
        law: LawNumbers[N],
        axis: AxisNumbers[N],
        arithmetic: Decisions[N],
        state: FuzzyState[Any],
        sample: Sample[Any],
    ) -> tuple[FuzzyState[N], N]:
        """(C.4) to (C.7), and the limits."""
        gains, angle_rad = axis.gains, sample.angle_rad
        error = arithmetic.saturate(
            (state.reference_2_rad - angle_rad) * gains.degrees, -gains.input_max, gains.input_max, law.zero
        )
        filtered_rad: Any = state.filtered_rad + gains.filter_gain * (angle_rad - state.filtered_rad)
        filtered_rad = arithmetic.saturate(filtered_rad, -gains.angle_max_rad, gains.angle_max_rad, law.zero)
        rate = arithmetic.saturate(
            (filtered_rad - angle_rad) * gains.rate_scale, -gains.input_max, gains.input_max, law.zero
        )
        strengths = self._strengths(gains, arithmetic, law.zero, (sample.region_rad * gains.degrees, rate, error))
        v_V = gains.output_V * self._centroid(gains, arithmetic, law.zero, strengths)
        u_V = v_V + sample.u_ff_V
        limited_V = arithmetic.saturate(u_V, axis.u_min_V, axis.u_max_V, axis.u_safe_V)
        return FuzzyState(state.reference_1_rad, state.reference_2_rad, filtered_rad), limited_V

    def _strengths(self, gains: Any, arithmetic: Any, zero: Any, inputs: tuple[Any, Any, Any]) -> list[Any]:
        """(C.5): how far each output set is asked for."""
        region, rate, error = (
            [self._membership(slopes, arithmetic, zero, gains.one, x) for slopes in sets]
            for sets, x in zip((gains.regions, gains.rates, gains.errors), inputs, strict=True)
        )
        strengths = [zero] * gains.outputs
        for r, d, e, output in gains.rules:
            strength = _lesser(arithmetic, _lesser(arithmetic, region[r], rate[d]), error[e])
            strengths[output] = _greater(arithmetic, strengths[output], strength)
        return strengths

    def _membership(self, slopes: Any, arithmetic: Any, zero: Any, one: Any, x: Any) -> Any:
        """(C.4)."""
        rising, falling = slopes[0] + slopes[1] * x, slopes[2] + slopes[3] * x
        return arithmetic.clamp(_lesser(arithmetic, rising, falling), zero, one)

    def _centroid(self, gains: Any, arithmetic: Any, zero: Any, strengths: list[Any]) -> Any:
        """(C.6) and (C.7) in units of the output's axis; zero where no rule fires."""
        moment = area = zero
        for node in gains.nodes:
            level = zero
            for output, membership in zip(node.sets, node.memberships, strict=True):
                level = _greater(arithmetic, level, _lesser(arithmetic, strengths[output], membership))
            moment = moment + node.moment * level
            area = area + node.width * level
        fired = arithmetic.is_less(zero, area)
        return arithmetic.choose(fired, moment, zero) / arithmetic.choose(fired, area, gains.one)


def _lesser(arithmetic: Any, one: Any, other: Any) -> Any:
    return arithmetic.choose(arithmetic.is_less(other, one), other, one)


def _greater(arithmetic: Any, one: Any, other: Any) -> Any:
    return arithmetic.choose(arithmetic.is_less(one, other), other, one)


def gains_of(wording: Wording, sample_period_s: float) -> FuzzyGains:
    """The numbers of one controller from its words."""
    labels = sorted(wording.outputs, key=lambda label: wording.outputs[label])
    regions = tuple(wording.regions)
    rules = tuple(
        (regions.index(region), rate_of(rate, ERROR_LABELS[place]), place, labels.index(output))
        for region in regions
        for rate in RATE_LABELS
        for place, output in enumerate(wording.rules[region][rate])
    )
    return FuzzyGains(
        degrees=180.0 / math.pi,
        rate_scale=180.0 / math.pi * wording.rate_period_s / FILTER_S,
        filter_gain=lag_gain(FILTER_S, sample_period_s),
        output_V=wording.unit_V,
        angle_max_rad=ANGLE_MAX_RAD,
        input_max=INPUT_MAX,
        one=1.0,
        regions=tuple(slopes_of(sides) for sides in wording.regions.values()),
        rates=(*(slopes_of(wording.rate[label]) for label in RATE_LABELS), ALWAYS),
        errors=tuple(slopes_of(wording.error[label]) for label in ERROR_LABELS),
        outputs=len(labels),
        rules=rules,
        nodes=_nodes([wording.outputs[label] for label in labels]),
    )


def rate_of(label: str, error: str) -> int:
    """The place of a rule's rate: rules 1 to 7 of the text do not ask for it (both rows of each table agree), 8 to 11 do."""
    return RATE_LABELS.index(label) if error in ("N", "P") else len(RATE_LABELS)


def slopes_of(sides: Trapezoid) -> Slopes:
    """(r_0, r_1, f_0, f_1) of the trapezoid that rises from a to b and falls from c to d."""
    a, b, c, d = sides
    rising = (1.0, 0.0) if b <= -SHOULDER_FOOT else (-a / (b - a), 1.0 / (b - a))
    falling = (1.0, 0.0) if c >= SHOULDER_FOOT else (d / (d - c), -1.0 / (d - c))
    return (*rising, *falling)


def _nodes(peaks: list[float]) -> tuple[OutputNode, ...]:
    """The nodes of the centroid: finer around zero, where the output sets are; every peak is one."""
    u = np.unique(
        np.round(np.concatenate([np.linspace(-2, 2, 41), np.linspace(-0.4, 0.4, 41), np.linspace(-0.1, 0.1, 21)]), 6)
    )
    width = np.zeros(u.size)
    width[1:] += np.diff(u) / 2.0
    width[:-1] += np.diff(u) / 2.0
    nodes = []
    for value, span in zip(u.tolist(), width.tolist(), strict=True):
        memberships = [float(np.interp(value, peaks, np.eye(len(peaks))[place])) for place in range(len(peaks))]
        sets = tuple(place for place, membership in enumerate(memberships) if membership > 0.0)
        nodes.append(OutputNode(value * span, span, sets, tuple(memberships[place] for place in sets)))
    return tuple(nodes)


def design(points: Points) -> LawTable[FuzzyGains]:
    """Both controllers as the paper states them; of the plant they take the feed-forward, the limits, and what its file has tuned."""
    found = tuned(points, "fuzzy", TUNABLE)
    return _table(points, WORDINGS) if found is None else _tuned_table(points, found)


def _table(points: Points, words: Mapping[str, Wording]) -> LawTable[FuzzyGains]:
    Ts_s = points.settings.sample_period_s
    axes = {axis: axis_table(points, axis, gains_of(wording, Ts_s), 0.0) for axis, wording in words.items()}
    origin = {
        axis: {"rules": sum(len(row) for table in w.rules.values() for row in table.values())}
        for axis, w in words.items()
    }
    return law_table("fuzzy", points, axes, origin)


WORDINGS = {"elevation": ELEVATION, "azimuth": AZIMUTH}


def _worded(axis: str, numbers: Numbers) -> Wording:
    """An axis' words with what the paper leaves open of them: the error's sets, the time of the derivative, the volts of a unit."""
    small, medium, big, leaves, reaches, rate_period_s, unit_V = numbers.values()
    return replace(
        WORDINGS[axis],
        error=error_sets(small, small * medium, small * medium * big, leaves, leaves + reaches),
        rate_period_s=rate_period_s,
        unit_V=unit_V,
    )


def _tuned_table(points: Points, found: Mapping[str, Numbers]) -> LawTable[FuzzyGains]:
    return _table(points, {axis: _worded(axis, numbers) for axis, numbers in found.items()})


def _open(
    smallest: tuple[float, float], leaves: tuple[float, float], reaches: tuple[float, float]
) -> tuple[OpenNumber, ...]:
    """Ranges: PS within the zoom of the figures, P anywhere on their axis, the derivative from half a sample to 2 s, a unit up to 1 MU."""
    return (
        OpenNumber("small_deg", *smallest),
        OpenNumber("medium_by_small", 1.2, 6.0),
        OpenNumber("big_by_medium", 1.2, 6.0),
        OpenNumber("leaves_0_deg", *leaves, linear=True),
        OpenNumber("reaches_1_after_deg", *reaches),
        OpenNumber("rate_period_s", 0.005, 2.0),
        OpenNumber("unit_V", 1.0, 10.0),
    )


TUNABLE = Tunable(
    open={
        "elevation": _open((0.5, 20.0), (-40.0, 20.0), (1.0, 80.0)),
        "azimuth": _open((0.5, 60.0), (-40.0, 40.0), (1.0, 200.0)),
    },
    table=_tuned_table,
    template="fuzzy_tuning.c.j2",
    flat=lambda gains: [value for slopes in gains.errors for value in slopes] + [gains.rate_scale, gains.output_V],
)

CONTROLLER = EquationController(
    name="fuzzy",
    title="Mamdani fuzzy, 90 and 18 rules",
    source="seed 001, section 4, Figs. 7-11 and Tables I-VI",
    plants="a helicopter of two axes, as `ce150`, on which it settles: its rules know no model, so it is flown there first",
    needs="its rules are of degrees of elevation and azimuth",
    note=(
        "has the rules of Tables I-VI, max-min inference and the centroid. The paper's stored text has the figures' labels and "
        "axes, not their curves: universes, output peaks, regions and rules are read from it. Open are the widths of the error's sets, the "
        "time of the derivative and the volts of the output's unit. Two of them decide whether the elevation settles: PS has its peak at "
        "1 deg, where rule 7 puts it (beyond +20 deg a peak at 5 deg answers more weakly than the arm falls), and N and P are one pair "
        "over +-20 deg, so that rules 8 to 11 damp small errors as well; the rest is chosen by flying the design plant. No integrator: "
        "a plant other than designed for leaves an error; and rules that damp at rest answer single encoder steps, so u_M swings "
        "by about 2 V either way while the arm stands. Mended are rule 2 (positive error, positive "
        "output), the outputs' names, the missing set Bneg, the output that is 0 where hovering takes half of the range (it is "
        "added to the feed-forward) and the scale of the output's axis; `controllers/fuzzy_sets.py` names each. The reference "
        "is not filtered, as in the paper. Where a plant file has [design.tuned.fuzzy], as `plants/ce150_velagic.toml`, what is open is "
        "taken from there: `twinlaw design --controller fuzzy --tune SEED` finds it by the same flight as the PID's gains."
    ),
    equations=lambda _: Fuzzy(),
    gains=FuzzyGains,
    tables=design,
    template="fuzzy.c.j2",
    tunable=TUNABLE,
)
