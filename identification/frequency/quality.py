"""How good an identification in the frequency domain is, by the one rule of records.quality."""

from identification.frequency.notes import doubts
from identification.frequency.responses.record import Record
from identification.frequency.result import FrequencyIdentification, TimeCheck
from identification.frequency.truth import Truth
from identification.results.quality import off_truth, told_flags
from records.quality import BRIDGED, FREE_RUN, MISFIT, Look, Quality, flag, missed_percent


def frequency_quality(found: FrequencyIdentification, truth: Truth | None = None) -> Quality:
    """Each matched pair against its random errors, each estimate against the `truth` where it is known, each check in time, flags."""
    checks = [look for check in found.checks for look in check_looks(check, found.fit.model.outputs)]
    return Quality(
        (
            *(MISFIT.look(f"{pair.input} to {pair.output}", pair.misfit) for pair in found.pairs if pair.points),
            *off_truth(found.result.estimates, {} if truth is None else truth.values),
            *checks,
            *(
                BRIDGED.look(f"{output} of {record.name}", 100.0 * share)
                for record in found.fit.records
                for output, share in _holes(record)
            ),
            *told_flags(found.result.estimates, found.fit.at_bound),
            *(flag(text) for text in (*filter(None, [found.doubt]), *doubts(found.fit, found.pairs))),
        )
    )


def _holes(record: Record) -> list[tuple[str, float]]:
    """The outputs of which samples lack, and the share."""
    return [(output, share) for output, share in record.bridged.items() if share > 0.0]


def check_looks(check: TimeCheck, outputs: tuple[str, ...]) -> list[Look]:
    """A free run on a record that was not matched, output by output."""
    return [
        FREE_RUN.look(f"{output} of {check.name}", missed_percent(rms, noise, rms / max(1.0 - fit, 1e-300)))
        for output, rms, noise, fit in zip(outputs, check.rms, check.noise, check.fit, strict=True)
    ]
