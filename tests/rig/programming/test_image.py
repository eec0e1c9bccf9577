"""The image that the board gets: reproducible, within its memories, with the vectors, sizes and names that others rely on."""

import pytest

from records.board import STM32G071
from records.errors import BadInput
from rig.programming.image import FIRMWARE_DIR, build_firmware, describe_image, linker_script
from tests.firmware.box import stand_in_law
from toolchain.host import CText
from toolchain.target import build_image

BOARD = STM32G071


@pytest.fixture(scope="module")
def image():
    return build_firmware(stand_in_law())


def test_the_first_words_are_the_stack_and_the_reset_vector(image):
    vectors = 16 + BOARD.interrupt_count
    words = [int.from_bytes(image.binary[at : at + 4], "little") for at in range(0, 4 * vectors, 4)]
    assert words[0] == image.symbols["_stack_top"].address == BOARD.ram.end
    assert words[1] == image.symbols["Reset_Handler"].address | 1
    handlers = {16 + number: f"{name}_Handler" for name, number in BOARD.interrupts.items()}
    assert {number: words[number] for number in handlers} == {
        number: image.symbols[name].address | 1 for number, name in handlers.items()
    }
    fault = image.symbols["Fault_Handler"].address | 1
    assert {words[number] for number in set(range(2, vectors)) - set(handlers)} == {fault}


def test_names_that_others_rely_on_are_in_the_image(image):
    names = {"law_step", "law_reset", "law_self_test", "LAW_TABLE_DIGEST", "_stack_top", "_stack_limit"}
    assert names <= set(image.symbols)
    assert image.symbols["_stack_top"].address - image.symbols["_stack_limit"].address == BOARD.stack_reserve_bytes


def test_sizes_add_up_to_the_binary(image):
    sizes = image.sizes
    assert sizes.flash_bytes <= len(image.binary) <= sizes.flash_bytes + 8  # alignment between sections
    assert sizes.ram_bytes + BOARD.stack_reserve_bytes <= BOARD.ram.size_bytes
    at = image.symbols["LAW_TABLE_DIGEST"].address - BOARD.flash.start
    assert image.binary[at : at + 32] == bytes(range(1, 33))


def test_the_same_texts_give_the_same_bytes_and_another_law_others(image, tmp_path):
    changed = {name: text.replace("10.0f *", "11.0f *") for name, text in stand_in_law().items()}
    assert build_firmware(stand_in_law(), tmp_path).elf == image.elf
    assert (tmp_path / "firmware.elf").read_bytes() == image.elf
    assert (tmp_path / "firmware.bin").read_bytes() == image.binary
    assert build_firmware(changed).binary != image.binary


def test_no_place_of_this_computer_is_in_the_image(image):
    for place in (str(FIRMWARE_DIR.parent), "site-packages", "/tmp"):
        assert place.encode() not in image.elf


def link_of(text: str) -> bytes:
    start = "void Reset_Handler(void);\nvoid Reset_Handler(void) { (void)use[0]; }\n"
    return build_image("limits", [CText("big.c", text + start)], linker_script(BOARD)).read_bytes()


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("static volatile char use[33000];\n", "RAM"),
        ("static volatile char use[30000];\n", "stack"),
        ("static const volatile char use[140000] = {1};\n", "flash"),
    ],
)
def test_what_does_not_fit_is_an_error_of_the_link(text, what):
    with pytest.raises(BadInput, match=what):
        link_of(text)


def test_an_error_in_a_source_is_named_with_file_and_line():
    broken = {**stand_in_law(), "law.c": stand_in_law()["law.c"] + "\nint broken(void) { return nothing; }\n"}
    line = broken["law.c"].count("\n")
    with pytest.raises(BadInput, match=rf"law\.c:{line}:\d+: error") as caught:
        build_firmware(broken)
    assert "\n" not in str(caught.value)


def test_a_silent_promotion_to_double_is_an_error():
    broken = {**stand_in_law(), "law.c": stand_in_law()["law.c"].replace("* 320.0f", "* 320.0")}
    with pytest.raises(BadInput, match="double"):
        build_firmware(broken)


def test_a_file_that_is_no_image_is_refused():
    with pytest.raises(BadInput, match="no-image"):
        describe_image(b"not an ELF file", "no-image.elf")
