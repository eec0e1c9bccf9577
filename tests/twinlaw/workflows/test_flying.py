"""How large the error of the integration is, told apart from what the law's own arithmetic loses."""

from pathlib import Path

from controllers.loading import load
from tests.own_plants import OwnPlant
from twinlaw.command import main
from twinlaw.workflows.chain.flying import halved_step
from twinlaw.workflows.reading import load_bound

SUSPENSION = OwnPlant(
    {
        "m_s": (300.0, 10.0, "kg"),
        "m_u": (40.0, 2.0, "kg"),
        "k_s": (16e3, 500.0, "N m^-1"),
        "c_s": (1000.0, 100.0, "N s m^-1"),
        "k_t": (190e3, 9e3, "N m^-1"),
        "c_t": (100.0, 50.0, "N s m^-1"),
        "F_max": (1500.0, 0.0, "N"),
    },
    {"travel_m": 1e-5},
    """
Z, V, W, D = symbol("z_m"), symbol("z_dot_m_s"), symbol("w_m"), symbol("w_dot_m_s")
F = symbol("F_N")
spring = p["k_s"] * (Z - W) + p["c_s"] * (V - D)
return Model(
    name="NAME",
    states=(Z, V, W, D),
    inputs=(F,),
    outputs={"travel_m": Z - W},
    parameters=PARAMETERS,
    rates={Z: V, W: D},
    axes=(
        Axis("body", Z, V, p["m_s"], F - spring, 0, None, None),
        Axis("wheel", W, D, p["m_u"], spring - F - p["k_t"] * W - p["c_t"] * D, 0, None, None),
    ),
    input_limits={F: (-p["F_max"], p["F_max"])},
    places=Places(
        inputs={"actuator": InputPlace(F, "N", 1000.0)},
        axes={"body": AxisPlace("z_m", "N", 500.0), "wheel": AxisPlace("w_m", "N", 500.0)},
        sensors={"sensor": SensorPlace("travel_m", "m", 0.1)},
    ),
)
""",
)
DESIGN = """
[design]
sample_period_s = 0.002

[design.body]
poles_rad_s = [-4, -5, [-6, 6], [-6, -6], -12, -14, [-15, 70], [-15, -70]]
prefilter_time_constant_s = 0.3
reference_min_m = -0.04
reference_max_m = 0.04
"""


def test_the_error_of_the_steps_is_not_what_float32_loses(tmp_path: Path) -> None:
    """Truth: the wheel's 74 rad/s turn by 0.15 rad in a step of 2 ms, of which RK4 misses some 0.15^5 / 120 = 6e-7 at most; of 40 mm
    that is 2.5e-8 m. A law of slow poles at this period loses increments in float32, and hunts by 0.7 mm whatever the step.
    """
    plant = SUSPENSION.write(tmp_path, "suspension")
    plant.write_text(plant.read_text() + DESIGN)
    assert main(["design", "--plant", str(plant), "--out", str(tmp_path)]) == 0
    error = halved_step(load_bound(plant), load(tmp_path / "controller.json")[1])
    assert 0.0 < error.estimate.max() < 2.5e-8
