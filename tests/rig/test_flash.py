"""Commands that program a board, and what is said when they cannot."""

from pathlib import Path

import pytest

from records.errors import BadInput
from rig.flash import boot_loader_command, openocd_command, run_flash


def test_openocd_programs_verifies_and_starts():
    command = openocd_command(Path("build/firmware.elf"))
    assert command == [
        "openocd", "-f", "board/st_nucleo_g0.cfg", "-c", "program {build/firmware.elf} verify reset exit",
    ]  # fmt: skip


@pytest.mark.parametrize("line_mode", ["8e1", "8n1"])
def test_the_boot_loader_writes_verifies_and_starts_at_the_start_of_flash(line_mode):
    command = boot_loader_command(Path("build/firmware.bin"), "/dev/ttyUSB0", line_mode=line_mode)
    assert " ".join(command) == f"stm32flash -m {line_mode} -w build/firmware.bin -v -g 0x08000000 /dev/ttyUSB0"


def test_a_missing_tool_is_named_with_its_remedy():
    with pytest.raises(BadInput, match="tool-that-is-not-there"):
        run_flash(["tool-that-is-not-there", "firmware.elf"])


def test_a_failing_tool_is_quoted_in_one_line(tmp_path):
    script = tmp_path / "openocd"
    script.write_text("#!/bin/sh\necho first\necho Error: no device found >&2\nexit 1\n")
    script.chmod(0o755)
    with pytest.raises(BadInput, match="Error: no device found") as caught:
        run_flash([str(script), "-f", "x"])
    assert "\n" not in str(caught.value)


def test_a_tool_that_succeeds_is_quoted(tmp_path):
    script = tmp_path / "stm32flash"
    script.write_text("#!/bin/sh\necho done $1\n")
    script.chmod(0o755)
    assert run_flash([str(script), "42"]) == "done 42"
