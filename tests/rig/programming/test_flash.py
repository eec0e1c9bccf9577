"""Commands that program a board; what is said when they cannot; stm32flash itself against an emulated boot loader."""

import json
import os
import shutil
import signal
import struct
from pathlib import Path

import pytest

from codegen.law import generate_law
from records.board import STM32G071
from records.errors import BadInput, VerificationFailed
from rig.emulator.boot_loader import Command, LoaderFaults
from rig.emulator.pty_port import PtyBootLoader
from rig.link.client import BoardClient, asked_identity
from rig.link.numbers import numbers_of
from rig.link.port import open_port
from rig.programming.flash import (
    boot_loader_command,
    flash_through_boot_loader,
    flash_through_st_link,
    identify_command,
    openocd_command,
)
from rig.programming.image import build_firmware
from tests.docs.reading.json_page import is_as_documented
from tests.law_tables import ce150_table
from tests.soak import sampled
from twinlaw.command import main
from twinlaw.verbs import flash as verb
from twinlaw.workflows.chain.boards import board_url

FLASH = STM32G071.flash
needs_stm32flash = pytest.mark.skipif(
    shutil.which("stm32flash") is None, reason="stm32flash is not installed (Debian: apt install stm32flash)"
)
HALF_WAY = FLASH.start + 0x1000
IDENTIFIED = "case $* in *-w*) ;; *) echo 'Device ID : 0x0460'; exit;; esac"  # as the tool, before it is told to write
VECTORS = struct.pack("<II", 0x20008000, FLASH.start + 0x101)


@pytest.fixture(scope="module", params=["float32", "fixed"])
def built(request, tmp_path_factory) -> tuple[Path, str]:
    folder = tmp_path_factory.mktemp(request.param)
    build_firmware(generate_law(ce150_table(), request.param), folder)
    return folder, request.param


@pytest.fixture(scope="module")
def image(tmp_path_factory) -> Path:
    """Any content behind its vectors will do where it is not started: 12 KiB of which no byte reads as erased."""
    path = tmp_path_factory.mktemp("image") / "firmware.bin"
    path.write_bytes(VECTORS + (bytes(range(255)) * 49)[8 : 12 * 1024])
    return path


@pytest.fixture
def fake_tool(tmp_path, monkeypatch):
    """A program that stands for a programming tool, first in the search path."""

    def make(name: str, script: str) -> None:
        path = tmp_path / name
        path.write_text(f"#!/bin/sh\n{script}\n")
        path.chmod(0o755)
        monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")

    return make


def test_openocd_programs_verifies_and_starts():
    command = openocd_command(Path("build/firmware.elf"))
    assert command == [
        "openocd", "-f", "board/st_nucleo_g0.cfg", "-c", "program {build/firmware.elf} verify reset exit",
    ]  # fmt: skip


@pytest.mark.parametrize(("port", "mode"), [("/dev/ttyUSB0", "8e1"), ("/dev/ttyACM3", "8e1"), ("/dev/pts/7", "8n1")])
def test_the_boot_loader_writes_verifies_and_starts_at_the_start_of_flash(port, mode):
    command = boot_loader_command(Path("build/firmware.bin"), port)
    assert " ".join(command) == f"stm32flash -m {mode} -w build/firmware.bin -v -g 0x08000000 {port}"
    assert " ".join(identify_command(port)) == f"stm32flash -m {mode} {port}"


def test_a_missing_tool_is_named_with_its_remedy(monkeypatch, tmp_path, image):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BadInput, match=r"no openocd on this computer.*apt install openocd.*with --port PORT"):
        flash_through_st_link(Path("firmware.elf"))
    with pytest.raises(BadInput, match=r"no stm32flash on this computer.*apt install stm32flash.*without --port"):
        flash_through_boot_loader(image, "/dev/ttyUSB0")


def test_an_st_link_that_is_not_there_is_bad_input_and_failed_programming_is_not(fake_tool):
    fake_tool("openocd", "echo Info : first; echo Error: open failed >&2; echo shutdown command invoked >&2; exit 1")
    with pytest.raises(BadInput, match=r"Error: open failed.*nothing was written") as refused:
        flash_through_st_link(Path("firmware.elf"))
    assert "\n" not in str(refused.value)
    assert "shutdown" not in str(refused.value)
    fake_tool("openocd", "echo '** Programming Started **'; echo '** Verify Failed **' >&2; exit 1")
    with pytest.raises(VerificationFailed, match=r"Verify Failed.*flash again"):
        flash_through_st_link(Path("firmware.elf"))


@pytest.mark.parametrize(
    "content",
    [
        b"",
        VECTORS[:7],
        bytes(4096),
        VECTORS[4:] * 100,
        VECTORS + bytes(FLASH.size_bytes),
        b"\x7fELF" + bytes(4096),
    ],
)
def test_what_is_no_image_for_the_chip_is_refused_before_the_port_is_opened(content, tmp_path):
    path = tmp_path / "firmware.bin"
    path.write_bytes(content)
    with pytest.raises(BadInput, match=rf"firmware\.bin: firmware image: got {len(content)} bytes.*twinlaw build"):
        flash_through_boot_loader(path, "/dev/no-such-port")


@pytest.mark.parametrize(
    ("tool", "port", "answer", "told"),
    [
        ("openocd", [], "", "the chip may hold a part of the image"),
        ("stm32flash", ["--port", "/dev/ttyUSB0"], "", "nothing was written"),
        ("stm32flash", ["--port", "/dev/ttyUSB0"], IDENTIFIED, "the chip may hold a part of the image"),
    ],
)
def test_ctrl_c_tells_what_the_chip_may_hold(tool, port, answer, told, image, fake_tool, tmp_path, capsys) -> None:
    (tmp_path / "firmware.elf").touch()
    (tmp_path / "firmware.bin").write_bytes(image.read_bytes())
    fake_tool(tool, f"{answer}\nkill -INT $PPID")
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        assert main(["flash", *port, "--out", str(tmp_path)]) == 128 + signal.SIGINT
    finally:
        signal.signal(signal.SIGINT, before)
    assert f"interrupted; {told}" in capsys.readouterr().err


@needs_stm32flash
def test_what_stm32flash_writes_boots_and_answers_with_its_tables_digest_on_the_same_line(built):
    folder, arithmetic = built
    table = ce150_table()
    with PtyBootLoader() as chip:
        flash_through_boot_loader(folder / "firmware.bin", chip.path)
        binary = (folder / "firmware.bin").read_bytes()
        assert bytes(chip.loader.flash) == binary + b"\xff" * (FLASH.size_bytes - len(binary))
        identity = asked_identity(chip.path)
        assert (identity.table_digest, identity.arithmetic) == (table.digest, arithmetic)
        numbers = numbers_of(table, arithmetic)
        with BoardClient.connect(chip.path, table_digest=table.digest, numbers=numbers) as client:
            assert client.self_test() == 0
    assert chip.stop is None


@needs_stm32flash
def test_an_older_image_in_the_flash_is_erased_first(image):
    with PtyBootLoader(flash=bytes(range(256)) * (FLASH.size_bytes // 256)) as chip:
        flash_through_boot_loader(image, chip.path)
        assert chip.loader.flash[: 12 * 1024] == image.read_bytes()


@needs_stm32flash
def test_a_chip_whose_loader_was_spoken_to_before_is_flashed_all_the_same(image):
    with PtyBootLoader() as chip:
        chip.loader.take(b"\x7f")
        flash_through_boot_loader(image, chip.path)
        assert chip.loader.flash[: 12 * 1024] == image.read_bytes()


# What goes wrong, what the message must hold, and whether anything may have been written: then it is a failed verification (1).
FAILURES = [
    (LoaderFaults(refused=frozenset({Command.GET})), ["NACK", "0x00", "docs/hardware.md", "nothing was written"], 2),
    (LoaderFaults(refused=frozenset({Command.GET_ID})), ["NACK", "0x02", "nothing was written"], 2),
    (LoaderFaults(chip_id=0x410), ["0x0410", "0x0460 (STM32G071)", "nothing was written", "--port"], 2),
    (LoaderFaults(chip_id=0x999), ["0x999", "nothing was written"], 2),
    (LoaderFaults(refused=frozenset({Command.ERASE})), ["NACK", "0x44", "erase", "flash again"], 1),
    (LoaderFaults(refused=frozenset({Command.WRITE})), ["NACK", "0x31", "0x08000000", "flash again"], 1),
    (LoaderFaults(refused=frozenset({Command.READ})), ["NACK", "0x11", "0x08000000", "flash again"], 1),
    (LoaderFaults(refused=frozenset({Command.GO})), ["NACK", "0x21", "written and verified", "reset"], 1),
    (LoaderFaults(refused_address=HALF_WAY), ["write", "0x08001000", "flash again"], 1),
    (LoaderFaults(worn_address=HALF_WAY + 1), ["verify", "0x08001001", "found 0xff", "flash again"], 1),
    (LoaderFaults(silent_after=5000), ["ACK", "0x08001", "flash again"], 1),
]


@needs_stm32flash
@pytest.mark.parametrize(
    ("faults", "words", "status"), sampled(FAILURES, FAILURES[::3]), ids=lambda value: str(value)[:60]
)
def test_a_loader_that_fails_gives_one_clear_line_and_its_exit_status(faults, words, status, image, capsys):
    with PtyBootLoader(faults) as chip:
        assert main(["flash", "--port", chip.path, "--out", str(image.parent)]) == status
        written = bytes(chip.loader.flash) != b"\xff" * FLASH.size_bytes
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.count("\n") == 1
    assert told.err.startswith("twinlaw: error: ")
    assert [word for word in (chip.path, *words) if word not in told.err] == []
    assert status == 1 or not written


@needs_stm32flash
def test_a_port_at_which_nothing_answers_and_one_that_is_not_there_are_bad_input(image, capsys):
    with PtyBootLoader(LoaderFaults(silent_after=0)) as chip:
        assert main(["flash", "--port", chip.path, "--out", str(image.parent)]) == 2
    told = capsys.readouterr().err
    assert all(word in told for word in ("timeout", "boot loader", "docs/hardware.md"))
    assert main(["flash", "--port", "/dev/no-such-port", "--out", str(image.parent)]) == 2
    assert "/dev/no-such-port" in capsys.readouterr().err


@needs_stm32flash
def test_the_verb_tries_all_of_it_on_an_emulated_chip(built, capsys):
    folder, arithmetic = built
    assert main(["flash", "--port", "emulated", "--out", str(folder)]) == 0
    assert f"table {ce150_table().digest[:16]}, {arithmetic}" in capsys.readouterr().out


def test_a_program_is_told_what_was_written_and_what_an_emulated_chip_says_it_is(
    built, fake_tool, monkeypatch, capsys
) -> None:
    folder, arithmetic = built
    fake_tool("openocd", "exit 0")
    monkeypatch.setattr(
        verb, "flash_emulated", lambda _: asked_identity(board_url("emulated", folder / "firmware.elf"))
    )
    for port in ([], ["--port", "emulated"]):
        assert main(["flash", *port, "--out", str(folder), "--json"]) == 0
        said = json.loads(capsys.readouterr().out)
        assert is_as_documented("flash", said)
        assert said["written"]
    assert (said["table_digest"], said["arithmetic"]) == (ce150_table().digest, arithmetic)


def test_an_image_of_the_other_arithmetic_is_refused_before_anything_is_written(
    built, fake_tool, tmp_path, capsys
) -> None:
    folder, arithmetic = built
    written = tmp_path / "written"
    fake_tool("openocd", f"touch {written}; exit 0")
    other = {"float32": "fixed", "fixed": "float32"}[arithmetic]
    assert main(["flash", "--out", str(folder), "--arithmetic", other]) == 2
    told = capsys.readouterr().err
    assert f"arithmetic: got {arithmetic}, expected {other}; nothing was written" in told
    assert not written.exists()
    assert main(["flash", "--out", str(folder), "--arithmetic", arithmetic]) == 0
    assert written.exists()


def test_a_binary_of_another_build_than_its_elf_is_refused_where_an_arithmetic_is_demanded(
    built, tmp_path, capsys
) -> None:
    folder, arithmetic = built
    (tmp_path / "firmware.elf").write_bytes((folder / "firmware.elf").read_bytes())
    (tmp_path / "firmware.bin").write_bytes((folder / "firmware.bin").read_bytes() + b"more")
    assert main(["flash", "--port", "/dev/nope", "--out", str(tmp_path), "--arithmetic", arithmetic]) == 2
    assert "another one than firmware.elf" in capsys.readouterr().err


PROTECTED = LoaderFaults(refused=frozenset({Command.READ, Command.WRITE, Command.ERASE, Command.GO}))


@needs_stm32flash
def test_a_protected_chip_is_told_as_that_with_what_lifts_it_and_what_it_costs(image, capsys):
    with PtyBootLoader(PROTECTED) as chip:
        assert main(["flash", "--port", chip.path, "--out", str(image.parent)]) == 2
    told = capsys.readouterr().err
    words = ["read-out protected", "nothing was written", f"`stm32flash -k {chip.path}`", "ERASES THE WHOLE FLASH"]
    assert [word for word in words if word not in told] == []


# Answers of stm32flash to a protected chip, whole, for computers without it.
READ = '*" -r "*'
REFUSES = f"""case $* in
{READ}) echo 'Got NACK from device on command 0x11' >&2; echo 'Failed to read memory at address 0x08000000' >&2; exit 1;;
*" -w "*) echo 'Got NACK from device on command 0x44' >&2; echo 'Failed to erase memory' >&2; exit 1;;
*) echo 'Device ID : 0x0460';; esac"""


@pytest.mark.parametrize(("also_read", "status", "word"), [(True, 2, "stm32flash -k"), (False, 1, "stm32flash -u")])
def test_what_cannot_be_erased_is_protected_where_it_cannot_be_read_either(
    also_read, status, word, image, fake_tool, capsys
):
    fake_tool("stm32flash", REFUSES if also_read else REFUSES.replace(READ, "$0"))
    assert main(["flash", "--port", "/dev/ttyUSB0", "--out", str(image.parent)]) == status
    assert word in capsys.readouterr().err


def test_stm32flash_gets_its_own_sequence_of_dtr_and_rts(image, fake_tool, tmp_path, capsys):
    asked = tmp_path / "asked"
    fake_tool(
        "stm32flash", f"echo $* >> {asked}; {IDENTIFIED}; echo 'Starting execution at address 0x08000000... done'"
    )
    given = ["--port", "/dev/ttyUSB0", "--out", str(image.parent), "--sequence=-dtr,rts:dtr"]
    assert main(["flash", *given]) == 0
    assert [line.split(" -i ")[1].split()[0] for line in asked.read_text().splitlines()] == ["-dtr,rts:dtr"] * 2
    assert main(["flash", *given[2:]]) == 2
    assert "--sequence" in capsys.readouterr().err


def test_a_port_that_somebody_has_is_not_flashed(image, fake_tool, tmp_path, capsys):
    fake_tool("stm32flash", f"touch {tmp_path / 'asked'}")
    ours, theirs = os.openpty()
    other = open_port(os.ttyname(theirs), timeout_s=0.1)
    assert main(["flash", "--port", os.ttyname(theirs), "--out", str(image.parent)]) == 2
    assert "in use" in capsys.readouterr().err
    assert not (tmp_path / "asked").exists()
    other.close()
    os.close(ours)
    os.close(theirs)
