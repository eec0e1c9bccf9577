"""Columns of a plant's run logs, derived from its equations."""

from records.log import LogColumns
from sim.model import Model


def log_columns(model: Model) -> LogColumns:
    """Inputs and outputs of the model; optional are its other states and one reference per output (psi_rad: psi_ref_rad)."""
    outputs = tuple(model.outputs)
    states = tuple(str(state) for state in model.states if str(state) not in outputs)
    return LogColumns(
        plant=model.name,
        inputs=tuple(str(variable) for variable in model.inputs),
        outputs=outputs,
        optional=(*states, *(reference_name(output) for output in outputs)),
        axes=tuple(axis.name for axis in model.axes),
    )


def reference_name(output: str) -> str:
    """The column of an output's reference: `_ref` stands before the unit."""
    quantity, unit = output.rsplit("_", 1)
    return f"{quantity}_ref_{unit}"
