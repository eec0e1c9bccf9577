"""What a page shows that is no command - C, a mapping, a plant's effects - is taken by what it is written for."""

import re
from pathlib import Path

import pytest

from codegen.law import generate_law
from recordings.mapping.mapping import load_mapping
from records.plant import load_plant
from sim.bind import bind
from tests.docs.reading.commands import PAGES, fenced, tongues
from tests.law_tables import ce150_table
from tests.test_project import ROOT
from toolchain.host import CText, build_shared

# The languages of fenced blocks, and the tests that run, compile, load or compare them.
HELD_BY = {
    "sh": "test_commands.py",
    "python": "test_commands.py",
    "toml": "test_blocks.py",
    "c": "test_blocks.py",
    "text": "test_python.py, test_new_plant.py, test_tutorial.py",
    "": "test_readme.py",
}
BOARD = """
int32_t encoder_psi(void);
int32_t encoder_phi(void);
void drive(int32_t main, int32_t tail);
void timer_interrupt(void);
"""
STUBS = """
int32_t encoder_psi(void) { return 0; }
int32_t encoder_phi(void) { return 0; }
void drive(int32_t main, int32_t tail) { (void)main; (void)tail; }
"""


def test_every_fenced_block_has_a_language_that_a_test_takes() -> None:
    for page in PAGES:
        assert tongues(page) <= set(HELD_BY), page
    for names in HELD_BY.values():
        assert all((ROOT / "tests" / "docs" / name).is_file() for name in names.split(", "))


@pytest.mark.parametrize("arithmetic", ["float32", "fixed"])
def test_the_interrupt_of_the_page_on_other_firmware_compiles_without_a_warning(arithmetic: str) -> None:
    """Beside the generated law in either arithmetic; what the board brings is declared as its page says."""
    (shown,) = fenced("docs/other-firmware.md", "c")
    law = generate_law(ce150_table(), arithmetic)
    body = shown.replace('#include "law.h"\n', f'#include "law.h"\n{BOARD}')
    build_shared("page", [CText("law.h", law["law.h"]), CText("law.c", law["law.c"]), CText("page.c", body + STUBS)])


def test_the_mapping_of_the_page_on_import_is_one(tmp_path: Path) -> None:
    (shown,) = fenced("docs/import.md", "toml")
    (tmp_path / "mapping.toml").write_text(shown)
    mapping = load_mapping(tmp_path / "mapping.toml")
    assert (mapping.plant, mapping.per_turn, len(mapping.columns)) == ("ce150", 4096.0, 5)


def test_the_effect_of_the_page_on_effects_is_one_of_a_plant_file(tmp_path: Path) -> None:
    (shown,) = fenced("docs/effects.md", "toml")
    plant = (ROOT / "plants" / "ce150.toml").read_text(encoding="utf-8")
    (tmp_path / "plant.toml").write_text(f"{plant}\n{shown}")
    named = set(re.findall(r"\[effects\.(\w+\.\w+)\.", shown))
    assert set(bind(load_plant(tmp_path / "plant.toml")).effects) == named
