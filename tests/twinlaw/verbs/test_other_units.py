"""Loops of other units than rad and V go the whole way: a carriage's position, a coil's current, a shaft's torque, a tank's level."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from design.operating_points import design_points
from design.settings import read_settings
from tests.docs.reading.json_page import is_as_documented
from tests.own_plants import BOAT, HEATER, NO_AXIS, RATE_ONLY, TANKS, OwnPlant
from tests.soak import sampled
from twinlaw.command import main
from twinlaw.workflows.reading import load_bound

PLANTS = Path(__file__).parents[3] / "plants"

EMPS = """
[design]
sample_period_s = 0.005

[design.carriage]
poles_rad_s = [-10.0, -12.0, -15.0, -20.0]
prefilter_time_constant_s = 0.1
reference_min_m = -0.1
reference_max_m = 0.1
"""
TORQUE = """
[design.shaft]
poles_rad_s = [-3.0, -4.0, -5.0, -6.0]
prefilter_time_constant_s = 0.3
reference_min_rad = -0.3
reference_max_rad = 0.3
u_min_Nm = -1.5
u_max_Nm = 1.5

[board]
theta_rad = { encoder = ["PA0", "PA1"] }
tau_Nm = { pwm = "PA8", direction = "PB0", full_scale_Nm = 2.0 }
"""
COIL = """
[design]
sample_period_s = 0.002

[design.coil]
poles_rad_s = [-40.0, -60.0]
prefilter_time_constant_s = 0.02
reference_min_A = -3.0
reference_max_A = 3.0

[board]
i_A = { analogue = "PA4", zero_scale_A = -5.12, full_scale_A = 5.12 }
u_V = { pwm = "PA8", direction = "PB0" }
"""
# A vessel that a pump fills and that leaks: A h' = k u - c h.
TANK_PLANT = OwnPlant(
    {"A": (0.02, 0.001, "m^2"), "k": (5e-5, 5e-6, "m^3 s^-1 V^-1"), "c": (4e-4, 4e-5, "m^2 s^-1")},
    {"level_m": 1e-4},
    """
h, u = symbol("level_m"), symbol("pump_V")
return Model(
    name="NAME", states=(h,), inputs=(u,), outputs={"level_m": h}, parameters=PARAMETERS,
    rates={h: (p["k"] * u - p["c"] * h) / p["A"]}, axes=(), input_limits={u: (0, 12)},
    places=Places(inputs={"pump": InputPlace(u, "V", 12.0)}, sensors={"gauge": SensorPlace("level_m", "m", 1.0)}),
)
""",
)
TANK = """
[design]
sample_period_s = 0.05

[design.vessel]
poles_rad_s = [-0.3, -0.4]
prefilter_time_constant_s = 2.0
reference_min_m = 0.2
reference_max_m = 1.0
"""
HEATED = """
[design]
sample_period_s = 0.05

[design.body]
poles_rad_s = [-0.5, -0.8]
prefilter_time_constant_s = 1.0
reference_min_K = 10.0
reference_max_K = 50.0
"""
LEVELS = """
[design]
sample_period_s = 0.05

[design.level]
poles_rad_s = [-0.1, -0.12, -0.15, -0.2]
prefilter_time_constant_s = 5.0
reference_min_m = 0.2
reference_max_m = 0.6
"""
BY_LEVEL = """
[design]
sample_period_s = 0.05
schedule = "h2_m"
h2_min_m = 0.2
h2_max_m = 0.6
operating_points = 7
coefficient_degree = 2

[design.level]
poles_rad_s = [-0.1, -0.12, -0.15, -0.2]
prefilter_time_constant_s = 5.0
"""
BY_RATE = """
[design]
schedule = "omega_rad_s"
omega_min_rad_s = -3.0
omega_max_rad_s = 3.0

[design.arm]
poles_rad_s = [-3.0, -4.0, -5.0, -6.0]
"""
BY_SPEED = """
[design]
schedule = "v_m_s"
v_min_m_s = 0.8
v_max_m_s = 2.0
operating_points = 5

[design.speed]
output = "v_m_s"
input = "thrust_N"
poles_rad_s = [-0.6, -0.8]
prefilter_time_constant_s = 1.5

[design.heading]
output = "psi_rad"
input = "rudder_rad"
poles_rad_s = [-0.8, -1.0, -1.2, -1.5]
prefilter_time_constant_s = 2.0
reference_min_rad = -1.0
reference_max_rad = 1.0
"""
BY_PLACE = EMPS.replace(
    "[design]\n",
    '[design]\nschedule = "q_m"\nq_min_m = -0.1\nq_max_m = 0.1\noperating_points = 9\ncoefficient_degree = 2\n',
)


def written(name: str, folder: Path) -> Path:
    """The plant's file with its wishes."""
    own = {"coil": (NO_AXIS, COIL), "tank": (TANK_PLANT, TANK), "heater": (HEATER, HEATED), "tanks": (TANKS, LEVELS)}
    own |= {"by_level": (TANKS, BY_LEVEL), "boat": (BOAT, BY_SPEED)}
    if name in own:
        plant, wishes = own[name]
        path = plant.write(folder, name)
        path.write_text(path.read_text().replace("resolution_A = 0.001", "resolution_A = 0.0025") + wishes)
        return path
    model, wishes = {
        "emps": ("emps", EMPS),
        "by_place": ("emps", BY_PLACE),
        "torque": ("torque_limited_pendulum", TORQUE),
    }[name]
    path = folder / f"{name}.toml"
    path.write_text((PLANTS / f"{model}.toml").read_text() + wishes)
    return path


@pytest.mark.parametrize(
    "name",
    sampled(
        ["emps", "by_place", "coil", "torque", "tank", "heater", "tanks", "by_level", "boat"],
        keep=["coil"],
    ),
)
def test_it_flies_the_whole_way(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Truth: 100 000 steps in both arithmetics, no bit differs; the image has flown, and the flight stayed with its references,
    every step settled. Of a law without schedule, in other units, no page speaks of angles and of the helicopter."""
    assert main(["run", "--plant", str(written(name, tmp_path)), "--out", str(tmp_path / "b"), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    found = json.loads((tmp_path / "b" / "verification.json").read_text())
    assert said["passed"]
    assert is_as_documented("run", said)
    assert len(found["equality"]) == 4
    assert all(row["steps"] >= 100_000 and row["mismatches"] == 0 for row in found["equality"])
    header = (tmp_path / "b" / "generated" / "law.h").read_text()
    table = json.loads((tmp_path / "b" / "controller.json").read_text())
    macro, key = {
        "emps": ("LAW_Q_REF_MAX_M", "reference_max_m"),
        "by_place": ("LAW_Q_MAX_M", "reference_max_m"),
        "heater": ("LAW_HEAT_MAX_W", "u_max_W"),
        "by_level": ("LAW_H2_MAX_M", "reference_max_m"),
        "boat": ("LAW_V_MAX_M_S", "reference_max_m_s"),
        "tanks": ("LAW_H2_REF_MAX_M", "reference_max_m"),
        "coil": ("LAW_I_REF_MAX_A", "reference_max_A"),
        "torque": ("LAW_TAU_MAX_NM", "u_max_Nm"),
        "tank": ("LAW_LEVEL_REF_MAX_M", "reference_max_m"),
    }[name]
    page = (tmp_path / "b" / "report.html").read_text()
    foreign = [
        words
        for words in ("Psi", "elevation", "at 0.0 deg", "over the rest", "other axis'", "voltages come")
        if words in page
    ]
    assert foreign == []
    assert "never" not in page
    assert macro in header
    assert key in str(table)


def test_a_law_is_scheduled_by_a_length(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Truth: the range in metres that the plant's file asks for, in the table and as what the C clamps the carriage's place to."""
    plant, table = written("by_place", tmp_path), tmp_path / "controller.json"
    assert main(["design", "--plant", str(plant), "--out", str(tmp_path)]) == 0
    assert main(["generate", "--table", str(table), "--out", str(tmp_path)]) == 0
    content, generated = json.loads(table.read_text()), tmp_path / "generated"
    assert (content["q_min_m"], content["q_max_m"]) == (-0.1, 0.1)
    assert {len(powers) for powers in content["carriage"]["q_V_m"]} == {3}
    assert re.findall(r"LAW_Q_M.._M \((.+)f\)", (generated / "law.h").read_text()) == ["-0.100000001", "0.100000001"]
    assert "clamp(self->q_m, LAW_Q_MIN_M, LAW_Q_MAX_M)" in (generated / "law.c").read_text()
    page = (tmp_path / "design.html").read_text()
    told = ("Margins over q of the carriage", "Coefficients over q of the carriage", ">at q<")
    assert [words for words in told if words not in page] == []
    assert "coupl" not in page
    assert "at q " in capsys.readouterr().out.splitlines()[0]


def test_a_speed_that_moves_a_position_schedules_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plant = RATE_ONLY.write(tmp_path, "arm")
    plant.write_text(plant.read_text() + BY_RATE)
    assert main(["design", "--plant", str(plant), "--out", str(tmp_path)]) == 2
    assert "got omega_rad_s, by which theta_rad moves" in capsys.readouterr().err


def test_a_boat_s_heading_is_scheduled_by_its_speed(tmp_path: Path) -> None:
    """Truth: the rudder turns it by v^2, what damps it is constant: q goes by v^-2, to rounding. It rests at each speed, heading 0."""
    bound = load_bound(written("boat", tmp_path))
    points = design_points(bound, read_settings(bound))
    assert [point.x0[0] for point in points.equilibria] == pytest.approx(np.linspace(0.8, 2.0, 5))
    assert all(point.x0[1] == 0.0 for point in points.equilibria)
    slow, *_, fast = points.axes[1]
    assert slow.delta.q == pytest.approx(fast.delta.q * (2.0 / 0.8) ** 2, rel=1e-6)


def test_a_key_in_another_unit_is_refused_by_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plant = written("emps", tmp_path)
    plant.write_text(plant.read_text().replace("reference_min_m", "reference_min_rad"))
    assert main(["design", "--plant", str(plant), "--out", str(tmp_path)]) == 2
    assert "reference_min_m" in capsys.readouterr().err
