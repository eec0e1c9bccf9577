"""The plant file: which equations, with which parameters, known how well, seen by which sensors."""

import hashlib
import keyword
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import tomlkit

from records.correlation import Correlation, parse_correlation
from records.errors import BadInput
from records.files import write_atomic
from records.text import checks
from records.text.reading import read_text, read_toml
from records.text.units import dimensions, unit_suffix

SCHEMA = "plant/1"
PLANTS = Path(__file__).resolve().parent.parent / "plants"  # what the project comes with
OWN_NAME = "plant.toml"  # of every plant in a folder of its own: it is called by its equations
Value = float | tuple[float, ...]


@dataclass(frozen=True)
class Parameter:
    """One parameter of the equations: a number or polynomial coefficients in ascending powers, SI units.

    `sd` is one standard deviation of what is known of it, in the same shape and unit; 0 means known exactly.
    """

    value: Value
    sd: Value
    unit: str
    source: str

    @property
    def values(self) -> tuple[float, ...]:
        """The value as a tuple, also where it is one number."""
        return self.value if isinstance(self.value, tuple) else (self.value,)

    @property
    def sds(self) -> tuple[float, ...]:
        """The standard deviations as a tuple of the same length as `values`."""
        return self.sd if isinstance(self.sd, tuple) else (self.sd,)

    @property
    def units(self) -> tuple[str, ...]:
        """The unit of each of `values`: entries of "[s^-1, rad^-1]" one by one, one unit for all of them where there is but one."""
        parts = self.unit.strip("[]").split(",") if self.unit.startswith("[") else [self.unit]
        return tuple(part.strip() for part in parts) * (len(self.values) // len(parts))


@dataclass(frozen=True)
class Equations:
    """Equations of one's own: a file beside the plant file, by its name and its text; `folder` tells where it was read."""

    file: str
    text: str
    folder: str = field(default=".", compare=False)

    @property
    def path(self) -> str:
        """Where whoever mends it finds it."""
        return str(Path(self.folder) / self.file)


@dataclass(frozen=True)
class Plant:
    """A plant as its file states it.

    `model` names its equations, those of the project's table or, where there are `equations` of its own, these by their file's stem.
    `sensors` maps an output name ("psi_rad") to the step of its encoder and `sensor_noise` to the standard deviation of the white
    noise before it, where there is any. `design` holds the file's wishes for the controller and `board` the pins on which its columns
    hang (sections [design] and [board], read by the design stage), `effects` the added effects (sections [effects.PLACE.NAME]), as
    plain tables.
    `correlation` tells how the parameters' sd hang together; without it they are independent.
    """

    name: str
    model: str
    parameters: Mapping[str, Parameter]
    sensors: Mapping[str, float]
    design: Mapping[str, Any] = field(default_factory=dict)
    effects: Mapping[str, Any] = field(default_factory=dict)
    sensor_noise: Mapping[str, float] = field(default_factory=dict)
    correlation: Correlation | None = None
    equations: Equations | None = None
    board: Mapping[str, Any] = field(default_factory=dict)

    def section(self, name: str) -> str:
        """Where a section of its file stands, as an error says it."""
        return f"plant {self.name!r}: {name}"


def load_plant(path: Path) -> Plant:
    """Read a plant file; raises BadInput naming the file, the key and the remedy.

    Names, shapes and signs that a model demands are checked where the model is known (sim.bind), not here.
    """
    inside = path / OWN_NAME
    missing = f"name the file in it, {inside}" if inside.is_file() else f"name yours with --plant, or one of {PLANTS}"
    content = read_toml(path, "plant file", missing)
    own = str(content.get("equations", "")).removesuffix(".py")
    return parse_plant(content, own if own and path.name == OWN_NAME else path.stem, str(path), path.parent)


def parse_plant(content: Mapping[str, Any], name: str, where: str, folder: Path = Path()) -> Plant:
    """A plant from the content of its file in `folder`; raises BadInput naming `where`, the file, and the key."""
    checks.schema(content, where, SCHEMA)
    if not {"equations", "model"} & content.keys():
        expected = "the file of the plant's equations, beside this one, or a model of the project's own"
        raise BadInput("equations", where, "nothing", expected, 'add equations = "my_arm.py", or model = "ce150"')
    source = "equations" if "equations" in content else "model"
    checks.keys(
        content, where, ("schema", source, "parameters", "sensors"), ("design", "board", "effects", "correlation")
    )
    equations = read_equations(content, where, folder)
    parameters = checks.table(content["parameters"], f"{where}: parameters")
    sensors = checks.table(content["sensors"], f"{where}: sensors")
    steps = {key: _sensor(key, value, f"{where}: sensors.{key}") for key, value in sensors.items()}
    numbers = {key: parameter_entry(value, f"{where}: parameters.{key}") for key, value in parameters.items()}
    correlation = content.get("correlation")
    return Plant(
        name=name,
        model=checks.text(content["model"], f"{where}: model") if equations is None else Path(equations.file).stem,
        parameters=numbers,
        sensors={key: resolution for key, (resolution, _) in steps.items()},
        design=checks.table(content.get("design", {}), f"{where}: design"),
        effects=checks.table(content.get("effects", {}), f"{where}: effects"),
        sensor_noise={key: noise for key, (_, noise) in steps.items() if noise > 0.0},
        correlation=None
        if correlation is None
        else parse_correlation(correlation, f"{where}: correlation", coefficient_names(numbers)),
        equations=equations,
        board=checks.table(content.get("board", {}), f"{where}: board"),
    )


def read_equations(content: Mapping[str, Any], where: str, folder: Path) -> Equations | None:
    """The file of `equations = "NAME.py"` in `folder`; None where the plant names a model. Raises BadInput."""
    if "equations" not in content:
        return None
    file = checks.text(content["equations"], f"{where}: equations")
    stem = file.removesuffix(".py")
    if stem == file or not stem.isidentifier() or not stem.isascii() or keyword.iskeyword(stem):
        expected = "the name of a Python file beside the plant file, of letters a to z, digits and _"
        raise BadInput("equations", f"{where}: equations", repr(file), expected, 'write equations = "my_arm.py", say')
    beside = f"the equations of {where} stand beside it; `twinlaw new-plant NAME --out DIR` writes both"
    return Equations(file, read_text(folder / file, "equations", beside), str(folder))


def plant_files(plant: Plant, name: str = OWN_NAME) -> Mapping[str, str]:
    """The plant's file, called `name`, and that of its own equations beside it where it has them: name -> text."""
    own = {} if plant.equations is None else {plant.equations.file: plant.equations.text}
    return {**own, name: plant_text(plant)}


def save_plant(path: Path, plant: Plant) -> None:
    """Write the plant to `path`, with its own equations beside it; raises BadInput where that cannot be written."""
    for name, text in plant_files(plant, path.name).items():
        write_atomic(path.with_name(name), text)


def plant_digest(plant: Plant) -> str:
    """SHA-256 of all that makes the plant: its file's text, and the text of its own equations."""
    return hashlib.sha256(
        "".join([plant_text(plant), *([plant.equations.text] if plant.equations else [])]).encode()
    ).hexdigest()


def coefficient_names(parameters: Mapping[str, Parameter]) -> tuple[str, ...]:
    """One name for each number: NAME, or NAME_0, NAME_1, ... for a list."""
    return tuple(
        f"{name}_{index}" if isinstance(entry.value, tuple) else name
        for name, entry in parameters.items()
        for index in range(len(entry.values))
    )


def plant_text(plant: Plant) -> str:
    """The plant as TOML text; reading it back gives an equal plant."""
    document = tomlkit.document()
    document["schema"] = SCHEMA
    document.update({"model": plant.model} if plant.equations is None else {"equations": plant.equations.file})
    document["parameters"] = {
        key: {"value": _plain(entry.value), "sd": _plain(entry.sd), "unit": entry.unit, "source": entry.source}
        for key, entry in plant.parameters.items()
    }
    document["sensors"] = {key: _sensor_table(plant, key) for key in plant.sensors}
    for section in ("design", "board", "effects"):
        if getattr(plant, section):
            document[section] = dict(getattr(plant, section))
    if plant.correlation is not None:
        rows = tomlkit.array()
        for row in plant.correlation.rows:
            rows.add_line(list(row))
        document["correlation"] = {"names": list(plant.correlation.names), "rows": rows.multiline(True)}
    return tomlkit.dumps(document)


def _plain(value: Value) -> float | list[float]:
    return list(value) if isinstance(value, tuple) else value


def parameter_entry(entry: Any, where: str) -> Parameter:
    """One parameter from its section of the file; raises BadInput for what is missing, unknown, negative or no unit."""
    section = checks.table(entry, where)
    checks.keys(section, where, ("value", "sd", "unit", "source"))
    value, sd = section["value"], section["sd"]
    length = len(value) if isinstance(value, list) else None
    result = Parameter(
        value=_value(value, f"{where}.value", length),
        sd=_value(sd, f"{where}.sd", length),
        unit=checks.text(section["unit"], f"{where}.unit"),
        source=checks.text(section["source"], f"{where}.source"),
    )
    for entry_sd in result.sds:
        if entry_sd < 0.0:
            raise BadInput(
                "sd", where, repr(entry_sd), "a standard deviation >= 0", "write 0 for a value known exactly"
            )
    _check_unit(result, where)
    return result


def _value(value: Any, where: str, length: int | None) -> Value:
    return checks.number(value, where) if length is None else checks.numbers(value, where, length)


def _check_unit(parameter: Parameter, where: str) -> None:
    try:
        found = dimensions(parameter.unit)
    except ValueError as error:
        raise BadInput("unit", where, repr(parameter.unit), "coherent SI units", str(error)) from error
    if len(found) not in (1, len(parameter.values)):
        count = f"one unit, or {len(parameter.values)}"
        raise BadInput("unit", where, repr(parameter.unit), count, "give one unit for each coefficient")


def _sensor(name: str, entry: Any, where: str) -> tuple[float, float]:
    """Step of the encoder and noise of a sensor, whose keys bear its unit: resolution_rad of psi_rad, resolution_m of q_m."""
    step, noise = _sensor_keys(name)
    section = checks.table(entry, where)
    checks.keys(section, where, (step,), (noise,))
    resolution = checks.positive(section[step], f"{where}.{step}")
    return resolution, checks.positive(section[noise], f"{where}.{noise}") if noise in section else 0.0


def _sensor_table(plant: Plant, name: str) -> dict[str, float]:
    step, noise = _sensor_keys(name)
    table = {step: plant.sensors[name]}
    return {**table, noise: plant.sensor_noise[name]} if name in plant.sensor_noise else table


def _sensor_keys(name: str) -> tuple[str, str]:
    unit = unit_suffix(name)
    return (f"resolution_{unit}", f"noise_{unit}") if unit else ("resolution", "noise")
