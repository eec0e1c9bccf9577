"""One file of equations per plant; this table is the only place that names them all."""

from collections.abc import Callable, Mapping

from sim.model import Model
from sim.plants import ce150, ce150_seed_literal

MODELS: Mapping[str, Callable[[], Model]] = {
    "ce150": ce150.model,
    "ce150_seed_literal": ce150_seed_literal.model,
}
