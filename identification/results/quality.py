"""How good an identification is, by the one rule of records.quality."""

from collections.abc import Mapping, Sequence

from identification.results.result import Estimated, Identification
from identification.uncertainty.residuals import ResidualTest
from records.quality import FREE_RUN, MISFIT, TRUTH, Colour, Look, Quality, flag, missed_percent


def identification_quality(result: Identification, truth: Mapping[str, float]) -> Quality:
    """Each channel against its sensor, each estimate against the `truth` where it is known, each log held out, and flags."""
    fits = [test for _, stage in result.stages for test in stage.residuals]
    contradicting = [
        f"{title}: {what}"
        for title, stage in result.stages
        for entries, what in ((stage.contradictions, "contradicts earlier data"), (stage.discords, "its runs contradict one another"))
        if entries
    ]  # fmt: skip
    return Quality(
        (
            *(look for test in fits for look in fit_looks(test)),
            *off_truth(result.estimates, truth),
            *(held_out_look(test) for test in result.holdout),
            *told_flags(result.estimates, result.at_bound),
            *(flag(text) for text in (*filter(None, [result.doubt]), *contradicting, *result.flags)),
            *([flag(f"interrupted before {', '.join(result.unfinished)}", Colour.RED)] if result.unfinished else []),
        )
    )


def fit_looks(test: ResidualTest) -> list[Look]:
    """What is left of a channel, where something is known of its sensor."""
    return [MISFIT.look(f"{test.channel} of {test.run}", test.rms / test.noise)] if test.noise else []


def held_out_look(test: ResidualTest) -> Look:
    """A prediction of a log that was not used."""
    return FREE_RUN.look(f"{test.channel} of {test.run}", missed_percent(test.rms, test.noise, test.motion_rms))


def off_truth(estimates: Sequence[Estimated], truth: Mapping[str, float]) -> list[Look]:
    """Each estimate that the data told and whose truth is known; a value that was kept is the plant file's."""
    known = [entry for entry in estimates if entry.identified and entry.name in truth and entry.sd > 0.0]
    return [TRUTH.look(entry.name, abs(entry.value - truth[entry.name]) / entry.sd) for entry in known]


def told_flags(estimates: Sequence[Estimated], at_bound: Sequence[str]) -> list[Look]:
    """What ended at a bound is no estimate; what the data do not tell is none of theirs."""
    untold = [entry.name for entry in estimates if not entry.identified]
    none = len(untold) == len(estimates)
    return [
        *([flag(f"{', '.join(at_bound)} at a bound", Colour.RED)] if at_bound else []),
        *([flag(f"not told by the data: {', '.join(untold)}", Colour.RED if none else Colour.AMBER)] if untold else []),
    ]
