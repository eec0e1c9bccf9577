"""Plants that are no helicopter, with wishes for their controllers: what the forward chain is tried on."""

import json
import re
from pathlib import Path
from typing import Any

from records.plant import load_plant
from sim.bind import BoundPlant, bind

NEW_PLANT = Path(__file__).parents[1] / "docs" / "new-plant.md"
PLANTS = Path(__file__).parents[1] / "plants"

# The project's own files say what is wished for.
AEROSHIELD, QUANSER = (dict(load_plant(PLANTS / f"{name}.toml").design) for name in ("aeroshield", "quanser_aero"))
MOTOR: dict[str, Any] = {
    "sample_period_s": 0.001,
    "shaft": {
        "poles_rad_s": [-8, -12, -70, -90, -940, -1000],
        "prefilter_time_constant_s": 0.1,
        "reference_min_rad": -3.0,
        "reference_max_rad": 3.0,
    },
}
INVERTED_ARM: dict[str, Any] = {
    "sample_period_s": 0.005,
    "arm": {
        "poles_rad_s": [-3, -6, -9, -12],
        "prefilter_time_constant_s": 0.6,
        "reference_min_rad": -0.2,
        "reference_max_rad": 0.2,
    },
}

WISHES = {"aeroshield": AEROSHIELD, "quanser_aero": QUANSER, "motor": MOTOR, "inverted_arm": INVERTED_ARM}

_ARM = '''"""An arm that stands on its hinge, driven by a motor: J theta'' = k u + m g l sin(theta) - b theta'."""

from functools import cache

import sympy

from sim.model import Axis, Model, ParameterSpec, named_symbols, symbol
from sim.places import AxisPlace, InputPlace, Places, SensorPlace

THETA, THETA_DOT, U = symbol("theta_rad"), symbol("theta_dot_rad_s"), symbol("u_V")
PARAMETERS = (
    ParameterSpec("J", 1, "kg m^2", "positive"),
    ParameterSpec("k", 1, "N m V^-1", "positive"),
    ParameterSpec("G", 1, "N m", "positive"),
    ParameterSpec("b", 1, "N m s", "non-negative"),
)


@cache
def model():
    p = named_symbols(PARAMETERS)
    gravity = p["G"] * sympy.sin(THETA)
    torque = p["k"] * U + gravity - p["b"] * THETA_DOT
    return Model(
        name="inverted_arm", states=(THETA, THETA_DOT), inputs=(U,), outputs={"theta_rad": THETA}, parameters=PARAMETERS,
        rates={THETA: THETA_DOT},
        axes=(Axis("arm", THETA, THETA_DOT, p["J"], torque, sympy.Integer(0), -sympy.Integer(1), sympy.Integer(1)),),
        input_limits={U: (-12, 12)},
        places=Places(
            inputs={"input": InputPlace(U, "V", 12.0)},
            axes={"arm": AxisPlace("theta_rad", "N m", 0.3, gravity=gravity, gravity_moment=p["G"])},
            sensors={"theta_sensor": SensorPlace("theta_rad", "rad")},
        ),
    )
'''
_PARAMETERS = {"J": (0.02, "kg m^2"), "k": (0.1, "N m V^-1"), "G": (0.4, "N m"), "b": (0.01, "N m s")}


def written(name: str, folder: Path) -> BoundPlant:
    """The motor of docs/new-plant.md or the arm above, written into `folder` as its user would."""
    return bind(load_plant(written_file(name, folder)))


def written_file(name: str, folder: Path, design: str = "") -> Path:
    """The same plant's file, with a section [design] behind it."""
    files = _motor() if name == "motor" else _arm()
    for file, text in files.items():
        (folder / file).write_text(text + (design if file == "plant.toml" else ""))
    return folder / "plant.toml"


def _motor() -> dict[str, str]:
    text = NEW_PLANT.read_text()
    found = re.findall(r"```(?:python|toml) motor/(\S+)\n(.*?)```", text, re.DOTALL)
    return {name: content for name, content in found if name in ("dc_motor.py", "plant.toml")}


def _arm() -> dict[str, str]:
    sections = "".join(
        f'[parameters.{name}]\nvalue = {value}\nsd = 0.0\nunit = "{unit}"\nsource = "made up for tests"\n'
        for name, (value, unit) in _PARAMETERS.items()
    )
    toml = (
        f'schema = "plant/1"\nequations = "inverted_arm.py"\n{sections}[sensors.theta_rad]\nresolution_rad = 1.0e-3\n'
    )
    return {"inverted_arm.py": _ARM, "plant.toml": toml}


def plant_file(name: str, folder: Path) -> Path:
    """A plant's file: the project's own, or one of those written here, in `folder`, with its wishes as [design]."""
    if name not in ("motor", "inverted_arm"):
        return PLANTS / f"{name}.toml"
    return written_file(name, folder, "\n" + _toml(WISHES[name], "design"))


def _toml(section: dict[str, Any], title: str) -> str:
    """A table of TOML: its values, then its own tables."""
    own = "".join(f"{key} = {json.dumps(value)}\n" for key, value in section.items() if not isinstance(value, dict))
    inner = "".join(_toml(value, f"{title}.{key}") for key, value in section.items() if isinstance(value, dict))
    return f"[{title}]\n{own}\n{inner}"
