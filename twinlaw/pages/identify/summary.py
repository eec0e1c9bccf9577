"""An identification as rows of text."""

from collections.abc import Container, Mapping, Sequence

from identification.results.notes import chance, relative
from identification.results.result import Estimated
from identification.stages.estimate import Estimate
from identification.uncertainty.residuals import ResidualTest
from twinlaw.pages.identify.truth import HEADING as TRUTH_HEADING
from twinlaw.pages.identify.truth import off, told, z

HEADING = ("parameter", "unit", "start", "estimate", "95 % interval", "sd", "")
AID_HEADING = ("besides", "unit", "estimate", "95 % interval", "sd")
FIT_HEADING = ("data", "run", "channel", "samples", "rms", "sensor alone", "fit", "correlated")


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
            f"{entry.value:.5g}",
            f"{entry.lower:.5g} .. {entry.upper:.5g}",
            _relative(entry),
            *(() if truth is None else _against(entry, truth.get(entry.name))),
            "at its bound" if entry.name in at_bound else "" if entry.identified else "not identified",
        )
        for entry in estimates
    ]


def _against(entry: Estimated, known: float | None) -> tuple[str, str, str]:
    return told(known), off(entry.value, known), z(entry.value, entry.sd, known)


def _relative(entry: Estimated) -> str:
    return relative(entry.sd / abs(entry.value)) if entry.value else f"{entry.sd:.2g}"


def aid_rows(aids: Sequence[Estimated]) -> list[tuple[str, ...]]:
    """One row for each quantity that the data needed and the plant file does not have."""
    return [row[:2] + row[3:6] for row in estimate_rows(aids)]


def fit_rows(stages: Sequence[tuple[str, Estimate]]) -> list[tuple[str, ...]]:
    """One row for each channel of each stage."""
    return [row for title, stage in stages for row in test_rows(title, stage.residuals)]


def test_rows(title: str, tests: Sequence[ResidualTest]) -> list[tuple[str, ...]]:
    """One row for each channel of each run."""
    return [
        (
            title,
            test.run,
            test.channel,
            f"{test.samples}",
            f"{test.rms:.3g}",
            f"{test.floor:.3g}" if test.floor else "",
            f"{100.0 * test.fit:.2f} %",
            "" if test.white else chance(test.whiteness_p),
        )
        for test in tests
    ]
