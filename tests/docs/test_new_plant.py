"""The tutorial for a new plant does what it says: its files are written, its programs print what it shows."""

import os
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from design.settings import DEFAULTS, MARGIN_DEFAULTS, read_settings
from records.plant import load_plant
from records.text import checks
from sim.bind import bind
from tests.other_plants import written_file
from tests.test_project import ROOT
from toolchain.cache import CACHE_DIR

PAGE = ROOT / "docs" / "new-plant.md"
BLOCK = re.compile(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", flags=re.MULTILINE | re.DOTALL)


# A motor of the page without the friction, half a standard deviation from what is stated, under commands that change four times a second.
STEADY = """
rng = np.random.default_rng(1)
spread = {name: parameters[name] for name in ("R", "K", "J", "b")}
moved = {
    name: replace(entry, value=abs(float(entry.values[0] + 0.5 * entry.sds[0] * rng.standard_normal())))
    for name, entry in spread.items()
}
rig = bind(replace(motor.plant, parameters={**parameters, **moved}))
u = 3.0 * np.sign(np.sin(2 * np.pi * 2.0 * t_s + 0.1)).reshape(-1, 1)
measured = simulate(rig, t_s, x0=[0.0, 0.0, 0.0], drive=u)
save_log(Path("steady.csv"), RunLog(columns, sample_period_s=1e-3, loop="open", t_s=t_s, u=u, y=measured.y))
"""


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, the file that it is to become if it names one, its text."""

    language: str
    file: str | None
    text: str


def blocks() -> list[Block]:
    return [Block(language, file or None, text) for language, file, text in BLOCK.findall(PAGE.read_text("utf-8"))]


def test_the_pages_motor_is_the_projects() -> None:
    for block in blocks():
        if block.file:
            assert (ROOT / "plants" / "dc_motor" / Path(block.file).name).read_text("utf-8") == block.text


def test_the_page_is_made_of_files_programs_and_their_output() -> None:
    found = blocks()
    assert PAGE.read_text("utf-8").count("```") == 2 * len(found)
    assert [block.file for block in found if block.file] == ["motor/dc_motor.py", "motor/plant.toml"]
    assert {block.language for block in found} == {"python", "toml", "text", "sh"}


@pytest.mark.soak
def test_every_block_of_the_page_works_in_its_order(tmp_path: Path) -> None:
    programs, commands, shown = [], [], []
    for block in blocks():
        if block.file:
            (tmp_path / block.file).parent.mkdir(exist_ok=True)
            (tmp_path / block.file).write_text(block.text, encoding="utf-8")
        elif block.language == "python":
            programs.append(block.text)
        elif block.language == "sh":
            commands.append(block.text)
        else:
            shown.append(block.text)
    printed = run([sys.executable, "-W", "error", "-"], tmp_path, "".join(programs))
    twinlaw = f"twinlaw() {{ {sys.executable} -c 'import sys; from twinlaw.command import main; sys.exit(main())' \"$@\"; }}\n"
    printed += run(["bash", "-e", "-o", "pipefail"], tmp_path, twinlaw + "".join(commands))
    assert printed == "".join(shown)
    # Truth: nothing is missing. At a steady speed the rounding of 3 mrad beats with the samples, up to 0.24 mrad coherently in this log.
    run([sys.executable, "-W", "error", "-"], tmp_path, "".join([*programs, STEADY]))
    verdict = "twinlaw diagnose --plant motor/plant.toml --out steady steady.csv | head -1\n"
    assert run(["bash", "-e"], tmp_path, twinlaw + verdict).startswith("no gap")


def test_the_equations_of_the_page_keep_the_project_s_style(tmp_path: Path) -> None:
    source = next(block.text for block in blocks() if block.file and block.file.endswith(".py"))
    ruff = [str(Path(sys.executable).parent / "ruff"), "--config", str(ROOT / "pyproject.toml")]
    path = tmp_path / "sim" / "plants" / "dc_motor.py"  # where Ruff takes `sim` for one package with the file
    path.parent.mkdir(parents=True)
    path.write_text(source, encoding="utf-8")
    run([ruff[0], "format", "--check", *ruff[1:], str(path)], ROOT)
    run([ruff[0], "check", *ruff[1:], str(path)], ROOT)


def run(command: list[str], folder: Path, standard_input: str = "") -> str:
    environment = {**os.environ, "TWINLAW_CACHE": str(CACHE_DIR), "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=folder, input=standard_input, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


KEYS_OF = (
    '[design]\nsample_period_s = 0.001\nschedule = "theta_rad"\ntheta_min_rad = -3.0\ntheta_max_rad = 3.0\n'
    + """
[design.shaft]
poles_rad_s = [-8.0, -12.0, -70.0, -90.0, -940.0, -1000.0]
reference_min_rad = -3.0
reference_max_rad = 3.0

[design.margins]

[board]
theta_rad = { encoder = ["PA0", "PA1"] }
u_V = { pwm = "PA8" }

[correlation]
names = ["R", "L"]
rows = [[1.0, 0.1], [0.1, 1.0]]
"""
)
# Where a section stands in what the loader names, and what the page calls it.
SECTIONS = {
    r"plant\.toml": "the file",
    r".*: parameters\.\w+": "`[parameters.NAME]`",
    r".*: sensors\.\w+": "`[sensors.OUTPUT]`",
    r".*: design": "`[design]`",
    r".*design\.shaft": "`[design.LOOP]`",
    r".*design\.margins": "`[design.margins]`",
    r".*board\.\w+": "`[board]`",
    r".*: correlation": "`[correlation]`",
}
# Other ways' keys, loops' names, and those of a loop's record, which are made of its section.
BESIDE = {
    "`[design]`": {"shaft"},
    "`[design.LOOP]`": {"axis", "motor", "pins"},
    "`[board]`": {"analogue", "zero_scale_rad", "full_scale_rad"},
    "the file": {"model"},
}


def test_the_page_has_every_key_that_the_loader_knows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Truth: the keys that each section is asked for while a plant with all of them is read, and those of the other ways beside."""
    known: dict[str, set[str]] = {}

    def keys(section: Mapping[str, Any], where: str, required: Sequence[str], optional: Sequence[str] = ()) -> None:
        name = next((name for place, name in SECTIONS.items() if re.fullmatch(place, where.rpartition("/")[2])), where)
        known.setdefault(name, set()).update(required, optional)

    path = written_file("motor", tmp_path, KEYS_OF)
    monkeypatch.setattr(checks, "keys", keys)
    read_settings(bind(load_plant(path)))
    told = {
        cells[1].strip(): set(re.findall(r"`(\w+)`", cells[2]))
        for line in PAGE.read_text().partition("## Every key")[2].splitlines()
        if len(cells := line.split("|")) > 3
    }
    for name, wanted in known.items():
        beside = BESIDE.get(name, set())
        if name in SECTIONS.values():
            assert told[name] - beside == wanted - beside, name
    assert set(SECTIONS.values()) <= set(known)


def test_the_page_has_the_defaults_of_the_keys() -> None:
    page = PAGE.read_text()
    for key, value in {**DEFAULTS, **MARGIN_DEFAULTS}.items():
        assert f"`{key}` ({value:g}" in page, key
