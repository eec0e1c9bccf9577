"""What a name predicts better: some thousand rows make any small thing certain, what changes no prediction is nothing to an engineer."""

from collections.abc import Mapping
from dataclasses import replace

from diagnosis import decisions
from diagnosis.decide.holdout import Holdout
from diagnosis.decide.idle import one_less
from diagnosis.decide.weighing import Explanations, Weighed, weigh
from diagnosis.decisions import held_against
from diagnosis.detect.linearisation import linearised
from diagnosis.fit.evidence import FittedHypothesis
from diagnosis.hypothesis.case import Case
from diagnosis.hypothesis.hypothesis import Hypothesis, passes
from diagnosis.search.free_curve import FittedCurve
from diagnosis.validate.fitted_logs import FittedLogs
from diagnosis.validate.judged_logs import JudgedLogs
from diagnosis.validate.score import score
from jobs.thread_map import thread_map
from records.reasons import Decision

TOLD_FROM = 0.02  # probability: of less probable ones no rule is told


def foreseen(logs: FittedLogs, explanations: Explanations) -> dict[FittedHypothesis, float]:
    """Nats by which the likeliest of what was tried, the same with one effect less, and parameters beyond their spread predict the logs
    better than the plant alone, over horizons from a row to a second (validate/score.py), in nats of all readings that share no error
    (`FittedLogs.readings`).

    What an effect gains in evidence alone it gains of the noise, row by row, or of what the others' forms are a little off. The
    `most_asked` that are likeliest without it are asked.
    """
    asked = list(weigh(explanations, {}).fitted[: decisions.most_asked()])
    fewer = [other for entry in asked for other in one_less(entry, explanations.named)]
    asked = list(dict.fromkeys([*asked, *fewer, *([] if explanations.beyond is None else [explanations.beyond])]))
    plain, readings = explanations.nominal.fit.hypothesis, logs.readings
    gains = thread_map(lambda entry: logs.gain(entry.fit.hypothesis, plain), asked)
    return {entry: readings * gain for entry, gain in zip(asked, gains, strict=True)}


def curve_foreseen(logs: JudgedLogs, with_curve: Case, curve: FittedCurve, plain: Hypothesis) -> float:
    """The same of a free curve in `logs` to which it is added, of signals as these had them: what is missing, not what foretells it."""
    judged = JudgedLogs(with_curve)
    hypothesis = judged.under_better_noise(curve.fit.hypothesis, plain)
    return logs.readings * score(judged.errors(hypothesis), logs.errors(plain)).gain


def curve_that_predicts(logs: JudgedLogs, curve: FittedCurve | None, plain: Hypothesis) -> FittedCurve | None:
    """The curve with what it predicts better of the logs that it was fitted to; None where that is nothing."""
    nats = 0.0 if curve is None else curve_foreseen(logs, curve.case, curve, plain)
    return None if curve is None or nats <= 0.0 else replace(curve, ahead_nats=nats)


def curve_with_held_out(curve: FittedCurve | None, holdout: Holdout) -> FittedCurve | None:
    """The curve, where there is one, with what it predicts of the hold-out beside what it does of the logs to explain; of a hold-out that
    the plant cannot follow it predicts nothing."""
    if curve is None or passes(holdout.case, holdout.base.fit.hypothesis) is None:
        return curve
    with_curve = curve.along(linearised(holdout.case, holdout.base.fit))
    nats = curve_foreseen(holdout.logs, with_curve, curve, holdout.base.fit.hypothesis)
    return replace(curve, ahead_nats=curve.ahead_nats + nats)


def foreseen_rules(foretold: Mapping[FittedHypothesis, float], weighed: Weighed) -> tuple[Decision, ...]:
    """The records of what the likely ones predict better, beside the likeliest."""
    shares = zip(weighed.fitted, weighed.probabilities, strict=True)
    likely = [entry for entry, p in shares if p >= TOLD_FROM and entry in foretold]
    if not likely:
        return ()
    first = foretold[likely[0]]
    return tuple(
        held_against(
            "foresees",
            " + ".join(entry.effects),
            foretold[entry],
            first,
            "nats",
            "likelier" if foretold[entry] > first else "no likelier",
        )
        for entry in likely
    )
