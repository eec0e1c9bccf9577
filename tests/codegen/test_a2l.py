"""The .a2l file: well formed, of the image's own addresses, and refused by a tool that checks the table's digest."""

import re
import struct
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from codegen.law import generate_law
from records.loops import Loop
from records.table import ControllerTable, table_text
from rig.emulator.board import EmulatedBoard
from rig.programming.image import build_firmware
from tests.codegen.test_any_loops import any_table
from tests.law_tables import ce150_table
from toolchain.dwarf import variable_members
from toolchain.elf import image_symbols
from twinlaw.command import main
from twinlaw.workflows.chain.building import image_a2l

_TOKEN = re.compile(r'"[^"]*"|/begin|/end|[^\s"]+')


@cache
def image(arithmetic: str = "float32") -> tuple[ControllerTable, bytes, str]:
    table = ce150_table()
    elf = build_firmware(generate_law(table, arithmetic)).elf
    return table, elf, image_a2l(table, arithmetic, elf)


def blocks(text: str) -> list[tuple[str, tuple[str, ...]]]:
    """Every /begin ... /end block, inner ones first, as (keyword, words); fails where they do not nest."""
    open_blocks: list[list[str]] = []
    found: list[tuple[str, tuple[str, ...]]] = []
    tokens = iter(_TOKEN.findall(text))
    for token in tokens:
        if token == "/begin":
            open_blocks.append([next(tokens)])
        elif token == "/end":
            block = open_blocks.pop()
            assert next(tokens) == block[0]
            found.append((block[0], tuple(block[1:])))
        elif open_blocks:
            open_blocks[-1].append(token)
    assert not open_blocks
    return found


def named(text: str, keyword: str) -> dict[str, tuple[str, ...]]:
    """The blocks of one kind by name."""
    return {words[0]: words for kind, words in blocks(text) if kind == keyword}


@pytest.mark.parametrize("arithmetic", ["float32", "fixed"])
def test_blocks_nest_names_are_unique_and_every_reference_is_defined(arithmetic: str) -> None:
    _, _, text = image(arithmetic)
    found = blocks(text)
    assert found[-1][0] == "PROJECT"
    measured = [words for kind, words in found if kind == "MEASUREMENT"]
    limits = [words for kind, words in found if kind == "CHARACTERISTIC"]
    names = [words[0] for words in (*measured, *limits)]
    assert len(set(names)) == len(names) > 90
    methods = set(named(text, "COMPU_METHOD")) | {"NO_COMPU_METHOD"}
    assert {words[3] for words in measured} | {words[6] for words in limits} <= methods
    assert {words[4] for words in limits} <= set(named(text, "RECORD_LAYOUT"))


@pytest.mark.parametrize("arithmetic", ["float32", "fixed"])
def test_arrays_have_the_three_dimensions_that_older_tools_demand(arithmetic: str) -> None:
    """ASAP2 1.6: MATRIX_DIM xDim yDim zDim; 1.7: any number of them."""
    _, _, text = image(arithmetic)
    told = re.findall(r"MATRIX_DIM ([^\n]*)", text)
    assert [dimensions for dimensions in told if not re.fullmatch(r"\d+ 1 1", dimensions)] == []
    assert "32 1 1" in told


def test_the_epk_is_the_digest_and_the_coefficients_are_told() -> None:
    table, _, text = image()
    assert f'EPK "{table.digest}"' in text
    value = f"{table.axes[0].q_V_rad[1][0]:.4g}"
    (told,) = re.findall(r'SYSTEM_CONSTANT "elevation_q_1_V_rad\[0\]" "([^"]+)"', text)
    assert f"{float(told):.4g}" == value


def test_a_tool_that_reads_by_the_file_sees_what_the_board_computes() -> None:
    """Truth: the board at rest has the digest in flash, the limits of the table, and its self-test passed."""
    table, elf, text = image()
    board = EmulatedBoard(elf)
    board.run_until_s(0.2)

    def read(name: str, size: int) -> bytes:
        words = named(text, "MEASUREMENT")[name]
        return board.read_memory(int(words[words.index("ECU_ADDRESS") + 1], 16), size)

    assert read("LAW_TABLE_DIGEST", 32).hex() == table.digest
    assert read("self_test_mismatches", 4) == bytes(4)
    assert 10 <= int.from_bytes(read("tick", 4), "little") <= 21
    limit = named(text, "CHARACTERISTIC")["elevation_limits.u_max_V"]
    assert struct.unpack("<f", board.read_memory(int(limit[3], 16), 4))[0] == table.axes[0].u_max_V


def test_fixed_point_words_are_told_with_their_places() -> None:
    _, _, text = image("fixed")
    signal = named(text, "MEASUREMENT")["output.u_M_V"]
    assert signal[2] == "SLONG"
    factor = float(named(text, "COMPU_METHOD")[signal[3]][-2])
    limit = named(text, "CHARACTERISTIC").get("elevation_limits.u_max_V")
    law_h = generate_law(ce150_table(), "fixed")["law.h"]
    (word,) = re.findall(r"#define LAW_U_M_MAX_V \((\d+)\)", law_h)
    assert int(word) * factor == ce150_table().axes[0].u_max_V
    assert limit is None or limit[2] == "VALUE"


def test_coefficients_are_told_as_the_words_of_the_c_have_them() -> None:
    """Truth: each constant of the C in fixed point, its word over its places; the table's own number is off by less than a place."""
    _, _, text = image("fixed")
    told = dict(re.findall(r'SYSTEM_CONSTANT "(\S+)" "(\S+)"', text))
    law_c = generate_law(ce150_table(), "fixed")["law.c"]
    word, places = re.findall(r"elevation_q_2\(.*?\[1\] = (-?\d+), /\* (\d+) places", law_c, flags=re.DOTALL)[0]
    assert float(told["elevation_q_2_V_rad[1]"]) == int(word) / 2.0 ** int(places)
    assert float(told["elevation_q_2_V_rad[1]"]) == pytest.approx(
        ce150_table().axes[0].q_V_rad[2][1], abs=2.0 ** -int(places)
    )


def test_a_loop_called_as_words_of_the_firmware_gets_its_image_and_description() -> None:
    """Truth: path_limits is a function of firmware/control/path.h, and one loop's limits are part of the code; EACH is a word in
    capitals that macros like. None of these is the loop's own, so nothing is missing."""
    loops = (Loop("path", "EACH_rad", "u_V", "path"),)
    table = replace(any_table((2,), None), loops=loops)
    law = generate_law(table, "float32")
    elf = build_firmware(law, loops=loops).elf
    assert "path_limits" in image_symbols(elf, "image")
    assert "law.path.v_V" in image_a2l(table, "float32", elf)


def test_members_lie_within_their_variable() -> None:
    _, elf, _ = image()
    place = image_symbols(elf, "image")["main.path"]
    members = variable_members(elf, "image", "main.path")
    assert members[0].address == place.address
    assert all(
        member.address + member.size_bytes * member.count <= place.address + place.size_bytes for member in members
    )


def test_the_same_image_gives_the_same_bytes_and_the_verb_writes_them(tmp_path: Path) -> None:
    table, _, text = image()
    (tmp_path / "controller.json").write_text(table_text(table))
    assert main(["build", "--table", str(tmp_path / "controller.json"), "--out", str(tmp_path)]) == 0
    assert (tmp_path / "firmware.a2l").read_text() == text


def test_limits_are_those_of_the_type_in_memory_to_the_last_digit() -> None:
    """Truth: 2^32 - 1 of an unsigned word; nine digits would be 5 above it."""
    _, _, text = image()
    assert named(text, "MEASUREMENT")["link.counters.frames_accepted"][-3] == "4294967295"
