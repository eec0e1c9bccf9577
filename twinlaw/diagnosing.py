"""The diagnosis as the command runs it: reads plant and logs, looks at the logs themselves first, leaves its files."""

from collections.abc import Sequence
from pathlib import Path

from diagnosis.engine import Material, diagnose
from diagnosis.integrity import demand, examine
from diagnosis.result import Result
from diagnosis.shrinkage import Predicted
from records.diagnosis import save_diagnosis
from records.errors import BadInput
from records.files import write_atomic
from records.log import RunLog, load_log
from records.log_csv import rows_text
from records.plant import plant_text
from records.units import unit_suffix
from sim.bind import BoundPlant
from sim.columns import log_columns
from sim.effects.api import without_effects
from twinlaw.console import stage
from twinlaw.stages import load_bound


def diagnose_logs(plant: Path, logs: Sequence[Path], holdout: Sequence[Path], out: Path) -> Result:
    """Diagnose log files against a plant file and write all results into `out`; raises BadInput."""
    with stage("reading the logs and looking at them"):
        bound = load_bound(plant)
        nominal = without_effects(bound) if bound.effects else bound
        material = _material(nominal, logs, holdout)
    with stage("searching for what the model lacks"):
        result = diagnose(nominal, material)
    write_result(result, out)
    return result


def _material(bound: BoundPlant, logs: Sequence[Path], holdout: Sequence[Path]) -> Material:
    columns = log_columns(bound.model)
    read = [load_log(path, columns) for path in (*logs, *holdout)]
    split = len(logs)
    names = [path.stem for path in (*logs, *holdout)]
    if len(set(names[split:])) != len(names[split:]):
        raise BadInput("hold-out logs", "--holdout", "two of one name", "names that differ", "rename one")
    integrity = examine(read[:split], bound, holdout=read[split:], names=names)
    demand(integrity)
    return Material(
        logs=read[:split],
        holdout=read[split:],
        holdout_names=names[split:],
        used=[~entry.excluded for entry in integrity.logs],
        notes=integrity.notes,
    )


def write_result(result: Result, out: Path) -> None:
    """diagnosis.json, plant.toml and the predictions."""
    logs = {flight.name: flight for flight in result.predicted}
    for name, predicted in logs.items():
        write_atomic(
            out / f"prediction-{name}.csv", prediction_text(predicted, list(result.case.kit.bound.model.outputs))
        )
    write_atomic(out / "plant.toml", plant_text(result.plant))
    save_diagnosis(out / "diagnosis.json", result.diagnosis)


def prediction_text(predicted: Predicted, outputs: Sequence[str]) -> str:
    """The rows of prediction-NAME.csv: measured, as stated, re-tuned, improved, by output; empty where nothing was predicted."""
    names, columns = ["t_s"], [predicted.t_s]
    for place, output in enumerate(outputs):
        unit = unit_suffix(output)
        stem = output.removesuffix(f"_{unit}") if unit else output
        names.append(output)
        columns.append(predicted.y[:, place])
        for bar in ("nominal", "before", "after"):
            names.append(f"{stem}_{bar}_{unit}" if unit else f"{output}_{bar}")
            columns.append(predicted.by[bar][:, place])
    return rows_text(names, columns, None).replace("nan", "")


__all__ = ["RunLog", "diagnose_logs", "prediction_text", "write_result"]
