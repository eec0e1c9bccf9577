"""A plant and its logs in; answers of plain ways to diagnose out, which a good one has to beat on the same files."""

from collections.abc import Callable, Mapping, Sequence

from diagnosis.baselines.bic import by_bic
from diagnosis.baselines.residual_size import by_residual_size
from diagnosis.baselines.sparse_regression import by_sparse_regression
from records.diagnosis import Diagnosis
from records.log import RunLog
from sim.bind import BoundPlant

# By name: what reads a nominal plant and its logs and answers as `twinlaw diagnose` does.
BASELINES: Mapping[str, Callable[[BoundPlant, Sequence[RunLog]], Diagnosis]] = {
    "residual-size": by_residual_size,
    "bic": by_bic,
    "sparse-regression": by_sparse_regression,
}
