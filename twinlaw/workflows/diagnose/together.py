"""The diagnosis as the command runs it: reads plant and logs, looks at the logs themselves first, leaves its files."""

from collections.abc import Container, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from threading import Thread

from diagnosis.diagnose import Material, diagnose
from diagnosis.result import Result
from diagnosis.validate.closed_loop import MODEL_VARIANTS
from diagnosis.validate.shrinkage import Predicted
from jobs.thread_map import through_when_interrupted
from logcheck.clock import from_their_start
from logcheck.integrity import demand, examine
from logcheck.stretches import stretches
from records.diagnosis import Firmware, diagnosis_text
from records.errors import BadInput
from records.files import demand_writable, remove_all, write_atomic
from records.log import RunLog, load_log
from records.plant import load_plant, plant_text
from records.reasons import Note
from records.table import ControllerTable
from records.text.log_csv import rows_text
from records.text.units import unit_suffix
from replay.firmware import FirmwareReplay
from replay.table import replay_log, table_of
from sim.added_effects import library, without_effects
from sim.bind import BoundPlant, bind
from sim.columns import log_columns
from toolchain.memory import keep_freed_memory
from twinlaw.cli.console import stage
from twinlaw.pages.diagnose.firmware import differs
from twinlaw.pages.diagnose.retune import moved_most
from twinlaw.pages.page import Page, page_text

PAGE = "twinlaw.pages.diagnose.report"
ANSWER = "diagnosis.json"


def diagnose_logs(plant: Path, logs: Sequence[Path], holdout: Sequence[Path], out: Path) -> Result:
    """Diagnose log files against a plant file and write all results into `out`; raises BadInput."""
    with writable(out):
        with stage("reading the logs and looking at them"):
            bound, material = read_material(plant, logs, holdout)
        with stage("searching for what the model lacks"), through_when_interrupted():
            Thread(target=_load_ahead, daemon=True).start()
            result = diagnose(bound, material)
        files = result_files(result, [path.name for path in logs])
        remove_all(earlier_predictions(out, files))
        for name, text in files.items():
            write_atomic(out / name, text)
    return result


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


def _load_ahead() -> None:
    """What the end needs takes a second to load, and Python has time while the filter runs; what fails to load is told where it is used."""
    with suppress(ImportError):
        for name in ("scipy.linalg", PAGE):
            import_module(name)


def read_material(plant: Path, logs: Sequence[Path], holdout: Sequence[Path]) -> tuple[BoundPlant, Material]:
    """What a diagnosis begins with; raises BadInput where plant or logs cannot be used."""
    keep_freed_memory()
    bound = bind(load_plant(plant))
    nominal = without_effects(bound) if bound.effects else bound
    return bound, _material(nominal, logs, holdout)


def _material(bound: BoundPlant, logs: Sequence[Path], holdout: Sequence[Path]) -> Material:
    columns = log_columns(bound.model)
    read = [load_log(path, columns) for path in (*logs, *holdout)]
    split = len(logs)
    names = [path.stem for path in (*logs, *holdout)]
    if len(set(names[split:])) != len(names[split:]):
        raise BadInput("hold-out logs", "--holdout", "two of one name", "names that differ", "rename one")
    integrity = examine(read[:split], bound, holdout=read[split:], names=names)
    demand(integrity)
    paths = (*logs, *holdout)
    replays = [replay_log(log, path) for log, path in zip(read, paths, strict=True)]
    firmware, told = _firmware(paths, replays)
    used = [~entry.excluded for entry in integrity.logs]
    timed, counted = from_their_start(read, names)
    parts = stretches(timed[:split], used[:split], names[:split])
    return Material(
        logs=parts.logs,
        names=parts.names,
        holdout=timed[split:],
        holdout_names=names[split:],
        used=[*parts.used, *used[split:]],
        firmware=firmware,
        notes=(*integrity.notes, *told, *counted, *parts.notes),
        tables=[_flown(*entry) for entry in zip(read[split:], holdout, replays[split:], strict=True)],
    )


def _flown(log: RunLog, path: Path, replay: FirmwareReplay | None) -> ControllerTable | None:
    """The table whose law flew a hold-out log; None where another firmware did: its error in the closed loop is not the model's."""
    own = table_of(log, path)
    return None if replay is not None and differs(replay.record()) else own


def _firmware(
    paths: Sequence[Path], replays: Sequence[FirmwareReplay | None]
) -> tuple[Firmware | None, tuple[Note, ...]]:
    """What running the controller's code again shows, of the first log where it differs, and a note for every log that it tells of."""
    found = [(path.name, replay) for path, replay in zip(paths, replays, strict=True) if replay is not None]
    if not found:
        return None, ()
    worst = min((replay for _, replay in found), key=lambda replay: (replay.bit_exact, replay.replayed))
    return worst.record(), tuple(
        Note("firmware", name, {}, f"{name}: {replay.sentence}") for name, replay in found if replay.sentence
    )


def result_files(result: Result, logs: Sequence[str]) -> Mapping[str, str]:
    """The predictions, plant.toml, diagnosis.json and the page by file name, in the order in which they are to be written."""
    outputs = list(result.case.library.bound.model.outputs)
    predictions = {f"prediction-{flight.name}.csv": prediction_text(flight, outputs) for flight in result.predicted}
    return {
        **predictions,
        "plant.toml": plant_text(result.plant),
        ANSWER: diagnosis_text(result.diagnosis),
        "report.html": page_text(_page(result, logs)),
    }


def _page(result: Result, logs: Sequence[str]) -> Page:
    from twinlaw.pages.diagnose import report

    bound = result.case.library.bound
    outputs = list(bound.model.outputs)
    curves = [
        report.Predicted(
            name=flight.name,
            t_s=flight.t_s,
            measured={output: flight.y[:, place] for place, output in enumerate(outputs)},
            **{
                variant: {output: flight.by[variant][:, place] for place, output in enumerate(outputs)}
                for variant in MODEL_VARIANTS
            },
        )
        for flight in result.predicted
    ]
    stories = {name: effect.story for name, effect in library(bound).items()}
    places = bound.model.places
    return report.diagnosis_page(
        bound.plant.name,
        result.diagnosis,
        places,
        stories,
        curves,
        logs,
        result.shape,
        moved_most(result),
        widths(result),
    )


def widths(result: Result) -> Mapping[str, float]:
    """How far apart the bounds of every parameter of the library are, by "place.effect.symbol"."""
    return {
        f"{name}.{symbol}": parameter.upper - parameter.lower
        for name, effect in library(result.case.library.bound).items()
        for symbol, parameter in effect.parameter.items()
    }


def prediction_text(predicted: Predicted, outputs: Sequence[str]) -> str:
    """The rows of prediction-NAME.csv: measured, as stated, re-tuned, improved, by output; empty where nothing was predicted."""
    names, columns = ["t_s"], [predicted.t_s]
    for place, output in enumerate(outputs):
        unit = unit_suffix(output)
        stem = output.removesuffix(f"_{unit}") if unit else output
        names.append(output)
        columns.append(predicted.y[:, place])
        for variant in MODEL_VARIANTS:
            names.append(f"{stem}_{variant}_{unit}" if unit else f"{output}_{variant}")
            columns.append(predicted.by[variant][:, place])
    return rows_text(names, columns, None).replace("nan", "")


__all__ = ["RunLog", "diagnose_logs", "prediction_text", "read_material", "result_files", "widths", "writable"]
