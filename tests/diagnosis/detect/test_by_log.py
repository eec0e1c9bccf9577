"""An effect that some logs have and others have not is sought in those that have it."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.detect.by_log import part_of_finite, parts, scores_by_log
from diagnosis.detect.linearisation import linearised
from diagnosis.detect.score_tests import score_effects
from diagnosis.fit.gauss_newton import fit
from diagnosis.hypothesis.hypothesis import passes
from diagnosis.search.fitting import Proposal, refined, rough
from tests.diagnosis.arm import arm, arm_case, arm_log
from tests.diagnosis.nominal import nominal_fit

SPRING = {"arm.cable_spring": {"k": 4e-4, "angle_0": 0.0, "h": 0.0}}
WIDE = (-30.0, 30.0)


def test_the_part_of_the_logs_that_shows_an_effect_is_found_with_its_size() -> None:
    # Truth: a size of 2 in the second of three logs, none in the others, under white innovations.
    case = arm_case(*(arm_log(seed=seed, seconds=4.0) for seed in (1, 2, 3)))
    linearisation = linearised(case, nominal_fit(case))
    rng = np.random.default_rng(8)
    column = rng.standard_normal((len(linearisation.w), 1))
    shown = np.repeat([0.0, 1.0, 0.0], [run.w.size for run in linearisation.runs])
    size = 2.0 * shown * column[:, 0]
    there = replace(linearisation, w=linearisation.w - size)
    (part,) = parts(there, column, [0.5 * float(size @ size) / 3.0], [WIDE])
    assert part is not None
    assert part.denied == {0, 2}
    assert part.size == pytest.approx(2.0, rel=0.1)
    (positive,) = parts(there, -column, [0.0], [(0.0, 30.0)])
    assert positive is None or positive.size >= 0.0


def test_what_each_log_says_is_together_what_all_say() -> None:
    # Truth: a score is a sum over logs; the thrust lies a standard deviation of what is known of it off, which pulls at it.
    index = [str(symbol) for symbol in arm().model.parameter_symbols].index("K")
    off = float(arm().p[index] + arm().sd[index])
    case = arm_case(*(arm_log(seed=seed, seconds=4.0, K=off) for seed in (1, 2)))
    linearisation = linearised(case, nominal_fit(case))
    columns = linearisation.slopes + np.random.default_rng(8).standard_normal(linearisation.slopes.shape)
    whole, (score, gram) = linearisation.scores_of(columns), scores_by_log(linearisation, columns)
    assert score.sum(axis=1) == pytest.approx(whole.score, abs=1e-3)
    assert gram.sum(axis=(1, 2)) == pytest.approx(np.diag(whole.gram))


def test_what_all_logs_deny_is_no_part_of_them() -> None:
    # Truth: no spring in either log; one of 4e-3 N m/rad makes each of them less likely.
    case = arm_case(*(arm_log(seed=seed, seconds=4.0) for seed in (1, 2)))
    nominal = nominal_fit(case)
    stiff = passes(case, nominal.hypothesis.with_effects({"arm.cable_spring": {"k": 4e-3, "angle_0": 0.0, "h": 0.0}}))
    assert stiff is not None
    plain = linearised(case, nominal).runs
    assert all(run.log_likelihood < other.log_likelihood for run, other in zip(stiff, plain, strict=True))
    assert part_of_finite(case, plain, stiff, -1e6) is None


def test_a_spring_in_one_of_two_logs_is_fitted_to_that_one() -> None:
    # Truth: a spring of 4e-4 N m/rad in the first log, none in the second; in both it is half as stiff, or less sure.
    case = arm_case(arm_log(SPRING, seed=21, seconds=10.0), arm_log(seed=22, seconds=10.0))
    nominal = nominal_fit(case)
    (seen,) = score_effects(case, linearised(case, nominal), list(SPRING))
    begun = rough(case, Proposal(nominal, seen))
    assert begun is not None
    end = refined(case, begun)
    assert end is not None
    lack = end.fit.hypothesis.lacks["arm.cable_spring"]
    assert lack.logs == {1}
    assert end.fit.hypothesis.effects["arm.cable_spring"]["k"] == pytest.approx(4e-4, rel=0.1)
    everywhere = fit(case, end.fit.hypothesis.with_effects({}).with_effects(end.fit.hypothesis.effects))
    assert everywhere is not None
    assert end.fit.log_posterior > everywhere.log_posterior + 20.0
