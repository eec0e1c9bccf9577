"""The page on the Python functions does what it says, and names all of them."""

import re
import sys
from pathlib import Path
from typing import Any

import pytest

import twinlaw
from records.errors import BadInput
from tests.docs.test_new_plant import run
from tests.plants import stated_table
from tests.test_project import ROOT
from twinlaw.command import main

PAGE = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", flags=re.MULTILINE | re.DOTALL)
SHOWN_ELSEWHERE = "within 0 sd of the true value"  # of the block whose output the page leaves out


def test_the_page_names_every_function() -> None:
    for name in twinlaw.__all__:
        assert f"`{name}`" in PAGE
        assert callable(getattr(twinlaw, name))
    with pytest.raises(AttributeError, match="no attribute 'crash'"):
        twinlaw.crash  # noqa: B018


def test_a_log_of_records_is_one_of_files(tmp_path: Path) -> None:
    # Truth: the same numbers in, the same numbers out, whether a log is a record or a file.
    plant = tmp_path / "plant.toml"
    stated = (ROOT / "plants" / "aeroshield.toml").read_text(encoding="utf-8")
    plant.write_text(stated.partition("[design]")[0], encoding="utf-8")  # both move it without a loop
    arm = twinlaw.load(plant)
    log = twinlaw.fly(arm)
    assert main(["simulate", "--plant", str(plant), "--out", str(tmp_path)]) == 0
    found, again = (twinlaw.identify(arm, logs) for logs in ({"run": log}, [tmp_path / "simulation.csv"]))
    assert [entry.value for entry in found.estimates] == [entry.value for entry in again.estimates]
    assert {entry.name for entry in found.estimates} == {"K", "c", "l"}


NOTHING: dict[str, Any] = {
    "no logs": (lambda arm: twinlaw.identify(arm, []), "logs: got none, expected at least one"),
    "no records": (lambda arm: twinlaw.diagnose(arm, {}), "logs: got none, expected at least one"),
    "one path": (
        lambda arm: twinlaw.diagnose(arm, "run.csv"),
        r"got one path, expected a list of them.*\[\"run.csv\"\]",
    ),
    "a table for files": (
        lambda arm: twinlaw.diagnose(arm, ["run.csv"], table=stated_table("aeroshield")),
        r"table: got one for files, expected the law of a file's flight beside it, as controller.json",
    ),
    "no such parameter": (lambda arm: twinlaw.identify(arm, ["run.csv"], free=["mass"]), "'mass'.*an unknown name"),
    "no step": (lambda arm: twinlaw.verify(arm, None, steps=0), "steps: got 0, expected a whole number from 1 on"),
}


@pytest.mark.parametrize(("call", "told"), NOTHING.values(), ids=NOTHING)
def test_what_a_function_cannot_use_is_told_as_its_verb_tells_it(call: Any, told: str) -> None:
    arm = twinlaw.load(ROOT / "plants" / "aeroshield.toml")
    with pytest.raises(BadInput, match=told):
        call(arm)


@pytest.mark.soak
def test_the_firmware_that_flew_a_record_is_run_again_where_its_table_is_given() -> None:
    """Truth: the C flew it on this computer, so not one bit differs; without the table nothing is run."""
    arm, table = twinlaw.load(ROOT / "plants" / "aeroshield.toml"), stated_table("aeroshield")
    flown = {"flight": twinlaw.fly(arm, table, on="host")}
    for given, bit_exact in ((table, True), (None, False)):
        firmware = twinlaw.diagnose(arm, flown, table=given).diagnosis.firmware
        assert firmware is not None
        assert (firmware.replayed, firmware.bit_exact) == (bit_exact, bit_exact)


@pytest.mark.soak
def test_every_block_of_the_page_works_in_its_order(tmp_path: Path) -> None:
    blocks = BLOCK.findall(PAGE)
    assert main(["new-plant", "my_arm", "--out", str(tmp_path / "my_arm")]) == 0
    program = "".join(text for language, text in blocks if language == "python")
    printed = run([sys.executable, "-W", "error", "-"], tmp_path, program)
    shown = [line for line in printed.splitlines(keepends=True) if SHOWN_ELSEWHERE not in line]
    assert "".join(shown) == "".join(text for language, text in blocks if language == "text")
    assert printed.count(SHOWN_ELSEWHERE) == 4
