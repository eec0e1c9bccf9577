"""Columns of a plant's run logs, derived from its equations."""

from records.logs.columns import LogColumns
from records.text.units import stem, unit_suffix
from sim.model import Model


def log_columns(model: Model) -> LogColumns:
    """Inputs and outputs of the model; optional are its other states, its signals and a reference per output (psi_ref_rad)."""
    outputs = tuple(model.outputs)
    states = tuple(str(state) for state in model.states if str(state) not in outputs)
    return LogColumns(
        plant=model.name,
        inputs=tuple(str(variable) for variable in model.inputs),
        outputs=outputs,
        optional=(*states, *model.signals, *(reference_name(output) for output in outputs)),
        axes=tuple(axis.name for axis in model.axes if axis.position is not None),
    )


def reference_name(output: str) -> str:
    """The column of an output's reference: `_ref` stands before the unit, q_rad_s: q_ref_rad_s."""
    unit = unit_suffix(output)
    return f"{stem(output)}_ref_{unit}" if unit else f"{output}_ref"
