"""The gate's last question: whether the law holds its plant in the arithmetic that flies, and not only in double precision."""

from pathlib import Path

import pytest

from design.settings import read_settings
from design.table import design
from records.errors import BadInput
from records.plant import load_plant
from sim.bind import BoundPlant, bind
from sim.tracking import left
from tests.own_plants import OwnPlant
from tests.plants import bound, stated_table
from twinlaw.workflows.chain.designing import design_plant
from twinlaw.workflows.chain.flying import fly_double, fly_host
from verification.settling import demand_settled

# Water in a heated pipe, five cells in a row: five equal poles at -2 rad/s, and wishes that are slower still.
PIPE = OwnPlant(
    {"tau": (0.5, 0.05, "s")},
    {"T5_K": 0.01},
    """
T1, T2, T3, T4, T5, U = (symbol(name) for name in ("T1_K", "T2_K", "T3_K", "T4_K", "T5_K", "heat_K"))
cells = (U, T1, T2, T3, T4, T5)
return Model(
    name="NAME", states=cells[1:], inputs=(U,), outputs={"T5_K": T5}, parameters=PARAMETERS,
    rates={cell: (before - cell) / p["tau"] for before, cell in zip(cells, cells[1:])},
    axes=(), input_limits={U: (0, 100)},
    places=Places(inputs={"heater": InputPlace(U, "K", 60.0)}, sensors={"probe": SensorPlace("T5_K", "K", 50.0)}),
)
""",
)
WISHES = """
[design]
sample_period_s = 0.02
[design.water]
poles_rad_s = [-0.8, -0.9, -1.0, -1.1, -1.2, -2.0, -2.2, -2.4, -2.6, -2.8]
prefilter_time_constant_s = 0.5
reference_min_K = 10.0
reference_max_K = 50.0
"""


def pipe(folder: Path) -> BoundPlant:
    path = PIPE.write(folder, "pipe")
    path.write_text(path.read_text() + WISHES)
    return bind(load_plant(path))


@pytest.mark.parametrize("arithmetic", ["float32", "fixed"])
def test_a_law_whose_own_arithmetic_loses_its_plant_is_refused(arithmetic: str, tmp_path: Path) -> None:
    # Truth: poles and margins of the rounded coefficients hold, double precision flies it, the generated law does not come to rest.
    plant = pipe(tmp_path)
    table, _ = design(plant, read_settings(plant))
    assert fly_double(plant, table).tracking[0].steady_error_rad < 0.1
    assert fly_host(plant, table, arithmetic).tracking[0].settling_s is None
    with pytest.raises(BadInput, match=rf"water at rest: law in {arithmetic}: got .* K off .* as in double precision"):
        design_plant(plant, arithmetic)


def test_a_law_that_holds_its_plant_passes() -> None:
    plant, table = bound("ce150"), stated_table("ce150")
    for arithmetic in ("float32", "fixed"):
        demand_settled(plant, table, arithmetic)
    assert left(fly_double(plant, table).tracking) == ()
