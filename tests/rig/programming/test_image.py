"""The image that the board gets: reproducible, within its memories, with the vectors, sizes and names that others rely on."""

import re
from pathlib import Path

import modm_devices
import pytest
from modm_devices.parser import DeviceParser

from records.errors import BadInput
from rig.programming.image import FIRMWARE_DIR, build_firmware, describe_image
from tests.firmware.box import stand_in_law
from toolchain.host import CText
from toolchain.target import build_image

BOARD = FIRMWARE_DIR / "board" / "stm32g071"
HEADER = (BOARD / "stm32g071.h").read_text()
STACK_RESERVE_BYTES = 4096
FLASH_START, RAM_END = 0x08000000, 0x20008000


@pytest.fixture(scope="module")
def image():
    return build_firmware(stand_in_law())


@pytest.fixture(scope="module")
def drivers():
    """The public description of the STM32G071RB, driver by driver."""
    devices = Path(modm_devices.__file__).parent / "resources" / "devices" / "stm32" / "stm32g0-71_81.xml"
    chip = next(d for d in DeviceParser().parse(str(devices)).get_devices() if d.identifier.string == "stm32g071rbi6")
    return {driver["name"]: driver for driver in chip.properties["driver"]}


def define(name: str) -> int:
    """Value of a plain #define of the register header."""
    (text,) = re.findall(rf"#define {name} (.+?)(?: /\*|$)", HEADER, re.MULTILINE)
    return int(eval(re.sub(r"(\d)u\b", r"\1", text)))  # products of decimal numbers only


@pytest.mark.parametrize(("ours", "theirs"), [("IRQ_TIM6", "TIM6_DAC_LPTIM1"), ("IRQ_USART2", "USART2")])
def test_interrupt_numbers_are_those_of_the_public_device_description(drivers, ours, theirs):
    positions = {vector["name"]: int(vector["position"]) for vector in drivers["core"]["vector"]}
    assert define(ours) == positions[theirs]
    assert define("IRQ_COUNT") > max(positions.values())


def test_memories_are_within_those_of_the_public_device_description(drivers):
    memories = {memory["name"]: memory for memory in drivers["core"]["memory"]}
    script = (BOARD / "link.ld").read_text()
    assert define("FLASH_SIZE_BYTES") == int(memories["flash"]["size"])
    assert define("RAM_SIZE_BYTES") <= int(memories["sram"]["size"])
    assert (
        f"ORIGIN = 0x{int(memories['flash']['start'], 16):08x}, LENGTH = {define('FLASH_SIZE_BYTES') // 1024}K"
        in script
    )
    assert (
        f"ORIGIN = 0x{int(memories['sram']['start'], 16):08x}, LENGTH = {define('RAM_SIZE_BYTES') // 1024}K" in script
    )


@pytest.mark.parametrize(
    ("source", "macro", "pin", "signal"),
    [
        ("encoders.c", "AF_TIM2", "0", ("tim", "2", "ch1")),
        ("encoders.c", "AF_TIM2", "1", ("tim", "2", "ch2")),
        ("encoders.c", "AF_TIM3", "6", ("tim", "3", "ch1")),
        ("encoders.c", "AF_TIM3", "7", ("tim", "3", "ch2")),
        ("pwm.c", "AF_TIM1", "MAIN_PIN", ("tim", "1", "ch1")),
        ("pwm.c", "AF_TIM1", "TAIL_PIN", ("tim", "1", "ch2")),
        ("usart.c", "AF_USART2", "2", ("usart", "2", "tx")),
        ("usart.c", "AF_USART2", "3", ("usart", "2", "rx")),
    ],
)
def test_pins_and_alternate_functions_are_those_of_the_public_device_description(drivers, source, macro, pin, signal):
    text = (BOARD / source).read_text()
    assert f"pin_alternate(PORT_A, {pin}, {macro}," in text
    number = pin if pin.isdigit() else re.findall(rf"#define {pin} (\d+)u", text)[0]
    (function,) = re.findall(rf"#define {macro} (\d+)u", text)
    (port_pin,) = (gpio for gpio in drivers["gpio"]["gpio"] if (gpio["port"], gpio["pin"]) == ("a", number))
    offered = {(s["driver"], s.get("instance"), s["name"]): s.get("af") for s in port_pin["signal"]}
    assert offered[signal] == function


def test_the_first_words_are_the_stack_and_the_reset_vector(image):
    words = [int.from_bytes(image.binary[at : at + 4], "little") for at in range(0, 4 * 48, 4)]
    assert words[0] == image.symbols["_stack_top"].address == RAM_END
    assert words[1] == image.symbols["Reset_Handler"].address | 1
    assert words[16 + define("IRQ_TIM6")] == image.symbols["TIM6_Handler"].address | 1
    assert words[16 + define("IRQ_USART2")] == image.symbols["USART2_Handler"].address | 1
    fault = image.symbols["Fault_Handler"].address | 1
    others = set(range(2, 48)) - {16 + define("IRQ_TIM6"), 16 + define("IRQ_USART2")}
    assert {words[number] for number in others} == {fault}


def test_names_that_others_rely_on_are_in_the_image(image):
    names = {"law_step", "law_reset", "law_self_test", "LAW_TABLE_DIGEST", "_stack_top", "_stack_limit"}
    assert names <= set(image.symbols)
    assert image.symbols["_stack_top"].address - image.symbols["_stack_limit"].address == STACK_RESERVE_BYTES


def test_sizes_add_up_to_the_binary(image):
    sizes = image.sizes
    assert sizes.flash_bytes <= len(image.binary) <= sizes.flash_bytes + 8  # alignment between sections
    assert sizes.ram_bytes + STACK_RESERVE_BYTES <= 32 * 1024
    at = image.symbols["LAW_TABLE_DIGEST"].address - FLASH_START
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
    return build_image("limits", [CText("big.c", text + start)], BOARD / "link.ld").read_bytes()


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
