"""The files of a diagnosis: what they hold, where they can be written, and which of an earlier run are out of date."""

from collections.abc import Container, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

import numpy as np

from diagnosis.result import Result
from diagnosis.validate.closed_loop import MODEL_VARIANTS
from diagnosis.validate.shrinkage import Predicted
from records.diagnosis import diagnosis_text
from records.files import demand_writable
from records.plant import plant_files
from records.text.log_csv import rows_text
from records.text.units import stem, unit_suffix
from twinlaw.pages.diagnose.quality import diagnosis_quality
from twinlaw.pages.diagnose.retune import moved_most
from twinlaw.pages.page import Page, page_text

ANSWER = "diagnosis.json"


def result_files(result: Result, logs: Sequence[str]) -> Mapping[str, str]:
    """The predictions, plant.toml, diagnosis.json and the page by file name, in the order in which they are to be written."""
    outputs = list(result.case.library.bound.model.outputs)
    predictions = {f"prediction-{log.name}.csv": prediction_text(log, outputs) for log in _by_log(result.predicted)}
    return {
        **predictions,
        **plant_files(result.plant),
        ANSWER: diagnosis_text(result.diagnosis, diagnosis_quality(result.diagnosis)),
        "report.html": page_text(_page(result, logs)),
    }


def _by_log(predicted: Sequence[Predicted]) -> list[Predicted]:
    """The predictions of each log as one, whatever stretches it was taken in."""
    found: dict[str, Predicted] = {}
    for later in predicted:
        first = found.get(later.name)
        found[later.name] = later if first is None else _joined(first, later)
    return list(found.values())


def _joined(one: Predicted, other: Predicted) -> Predicted:
    by = {variant: np.concatenate([values, other.by[variant]]) for variant, values in one.by.items()}
    return replace(one, t_s=np.append(one.t_s, other.t_s), y=np.concatenate([one.y, other.y]), by=by)


def _page(result: Result, logs: Sequence[str]) -> Page:
    from twinlaw.pages.diagnose import pictures, report  # with Matplotlib, which the filter need not wait for

    bound = result.case.library.bound
    outputs = list(bound.model.outputs)
    curves = [
        pictures.Predicted(
            name=flight.name,
            t_s=flight.t_s,
            measured={output: flight.y[:, place] for place, output in enumerate(outputs)},
            **{
                variant: {output: flight.by[variant][:, place] for place, output in enumerate(outputs)}
                for variant in MODEL_VARIANTS
            },
        )
        for flight in _by_log(result.predicted)
    ]
    return report.diagnosis_page(bound, result.diagnosis, curves, logs, result.shape, moved_most(result))


def prediction_text(predicted: Predicted, outputs: Sequence[str]) -> str:
    """The rows of prediction-NAME.csv: measured, as stated, re-tuned, improved, by output; empty where nothing was predicted."""
    names, columns = ["t_s"], [predicted.t_s]
    for place, output in enumerate(outputs):
        unit = unit_suffix(output)
        names.append(output)
        columns.append(predicted.y[:, place])
        for variant in MODEL_VARIANTS:
            names.append(f"{stem(output)}_{variant}_{unit}" if unit else f"{output}_{variant}")
            columns.append(predicted.by[variant][:, place])
    return rows_text(names, columns, None).replace("nan", "")


@contextmanager
def writable(out: Path) -> Iterator[None]:
    """Raise BadInput at once where `out` cannot be written; folders made for it are gone again where the body then fails."""
    absent = _absent(out)
    try:
        demand_writable(out / ANSWER)
        yield
    except BaseException:  # Ctrl-C too must leave nothing behind
        for folder in absent:
            with suppress(OSError):  # of one that holds something by now
                folder.rmdir()
        raise


def _absent(out: Path) -> list[Path]:
    """The folders that are to be made for `out`, the innermost first."""
    with suppress(OSError):  # what may not even be looked at is told by who writes there
        return [folder for folder in (out, *out.parents) if not folder.exists()]
    return []


def earlier_predictions(out: Path, files: Container[str]) -> list[Path]:
    """Predictions that a run before left in `out` and that are not among the new `files`; a log of such a name has a sidecar."""
    return [
        path
        for path in out.glob("prediction-*.csv")
        if path.is_file() and path.name not in files and not path.with_suffix(".toml").exists()
    ]
