"""Plants and logs as the verbs read them."""

from pathlib import Path

from records.errors import BadInput
from records.log import RunLog, load_log
from records.logs.sidecar import plant_of_log
from records.plant import load_plant
from sim.bind import BoundPlant, bind
from sim.columns import log_columns
from sim.plants import MODELS


def load_bound(path: Path) -> BoundPlant:
    """Read a plant file and bind it to its equations; raises BadInput."""
    return bind(load_plant(path))


def load_known_log(path: Path, bound: BoundPlant | None = None) -> RunLog:
    """Read a run log of `bound`, or of any plant that the table of models has; raises BadInput."""
    plant = plant_of_log(path)
    if bound is not None and plant == bound.nominal.name:
        return load_log(path, log_columns(bound.nominal))
    if plant not in MODELS:
        expected, remedy = (
            f"one of {', '.join(MODELS)}",
            "name a known plant, or give the plant file of your own with --plant",
        )
        if bound is not None:
            expected, remedy = repr(bound.nominal.name), "give the log and the plant of one rig"
        raise BadInput("plant", str(path.with_suffix(".toml")), repr(plant), expected, remedy)
    return load_log(path, log_columns(MODELS[plant]()))
