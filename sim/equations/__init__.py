"""A plant's record in; its nominal equations out: those of the project's table, or those that a file beside the plant file states."""

from functools import lru_cache

from records.errors import BadInput
from records.plant import Equations, Plant
from sim.equations.check import check_model
from sim.equations.own_file import run_file
from sim.model import Model
from sim.plants import MODELS


def nominal_model(plant: Plant) -> Model:
    """The equations without effects: the same object for the same plant. Raises BadInput, of a file of one's own with the line."""
    if plant.equations is not None:
        return _own(plant.equations)
    if plant.model not in MODELS:
        remedy = 'name a model that exists, or write equations = "NAME.py" for a file of your own'
        raise BadInput("model", f"plant {plant.name!r}", repr(plant.model), f"one of {', '.join(MODELS)}", remedy)
    return MODELS[plant.model]()


@lru_cache(maxsize=64)
def _own(equations: Equations) -> Model:
    model = run_file(equations)
    check_model(model, equations)
    return model
