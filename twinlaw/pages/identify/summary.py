"""An identification as rows of text."""

from collections.abc import Container, Mapping, Sequence

from identification.results.notes import chance, relative
from identification.results.quality import fit_looks, held_out_look
from identification.results.result import Estimated
from identification.stages.estimate import Data, Estimate
from identification.uncertainty.residuals import ResidualTest
from records.text.uncertain import interval, to_sd
from twinlaw.pages.identify.truth import HEADING as TRUTH_HEADING
from twinlaw.pages.identify.truth import off, told, z
from twinlaw.pages.measured import measured
from twinlaw.pages.quality import colour_of

HEADING = ("parameter", "unit", "start", "estimate", "95 % interval", "sd", "")
AID_HEADING = ("besides", "unit", "estimate", "95 % interval", "sd")
FIT_HEADING = ("data", "run", "channel", "samples", "rms", "sensor alone", "fit", "correlated", "")

# Beside the table of estimates, for whoever compares an interval with the value and the sd.
SCALE = (
    "A parameter that must be positive is taken as normal by its logarithm: its interval is one of factors, and ends above zero. "
    "That of one that must not be negative ends at 0."
)


def remarked(count: int) -> str:
    """How many remarks there are."""
    return "1 remark" if count == 1 else f"{count} remarks"


def estimate_heading(truth: Mapping[str, float] | None) -> tuple[str, ...]:
    """The heading of `estimate_rows`."""
    return HEADING if truth is None else (*HEADING[:-1], *TRUTH_HEADING, HEADING[-1])


def estimate_rows(
    estimates: Sequence[Estimated], at_bound: Container[str] = (), truth: Mapping[str, float] | None = None
) -> list[tuple[str, ...]]:
    """One row for each coefficient; those `at_bound` are marked, and the `truth` stands beside them where it is known."""
    return [
        (
            entry.name,
            entry.unit,
            f"{entry.start:.4g}",
            to_sd(entry.value, entry.sd),
            interval(entry.lower, entry.upper, entry.sd),
            _relative(entry),
            *(() if truth is None else _against(entry, truth.get(entry.name))),
            "at its bound" if entry.name in at_bound else _untold(entry),
        )
        for entry in estimates
    ]


def _against(entry: Estimated, known: float | None) -> tuple[str, str, str]:
    return told(known, entry.sd), off(entry.value, known, entry.unit), z(entry.value, entry.sd, known)


def _untold(entry: Estimated) -> str:
    return "" if entry.identified else "poorly told"


def _relative(entry: Estimated) -> str:
    return relative(entry.sd / abs(entry.value)) if entry.value else f"{entry.sd:.2g}"


def aid_rows(aids: Sequence[Estimated]) -> list[tuple[str, ...]]:
    """One row for each quantity that the data needed and the plant file does not have."""
    return [row[:2] + row[3:6] for row in estimate_rows(aids)]


def fit_rows(stages: Sequence[tuple[Data, Estimate]]) -> list[tuple[str, ...]]:
    """One row for each channel of each stage."""
    return [
        (*row, colour_of(fit_looks(test)))
        for data, stage in stages
        for test, row in zip(stage.residuals, _test_rows(data.title, stage.residuals), strict=True)
    ]


def held_out_rows(tests: Sequence[ResidualTest]) -> list[tuple[str, ...]]:
    """One row for each channel of each log that was kept from the fit."""
    rows = _test_rows("held out", tests)
    return [(*row, colour_of([held_out_look(test)])) for test, row in zip(tests, rows, strict=True)]


def _test_rows(title: str, tests: Sequence[ResidualTest]) -> list[tuple[str, ...]]:
    return [
        (
            title,
            test.run,
            test.channel,
            f"{test.samples}",
            measured(test.rms, test.channel),
            measured(test.noise, test.channel) if test.noise else "",
            f"{100.0 * test.fit:.2f} %",
            "" if test.white else chance(test.whiteness_p),
        )
        for test in tests
    ]
