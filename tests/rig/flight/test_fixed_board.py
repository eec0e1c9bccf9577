"""A board with the fixed-point law on its line: words both ways, its identity, and no arithmetic in software in its image."""

import math

import pytest

from codegen.law import generate_law
from records.errors import BadInput
from rig.flight.line_law import LineLaw
from rig.link.client import BoardClient
from rig.link.numbers import FixedNumbers, Float32Numbers, numbers_of
from rig.programming.image import FirmwareImage, build_firmware, refuse_soft_arithmetic
from tests.law_tables import ce150_table
from toolchain.calls import callers_of
from verification.equality import compare
from verification.fixed_stimuli import fixed_sequences
from verification.host_law import host_law
from verification.stateless import Stateless


@pytest.fixture(scope="module")
def image(tmp_path_factory: pytest.TempPathFactory) -> tuple[FirmwareImage, str]:
    folder = tmp_path_factory.mktemp("fixed")
    built = build_firmware(generate_law(ce150_table(), "fixed"), folder)
    return built, f"emulated://{folder / 'firmware.elf'}"


@pytest.mark.parametrize(
    ("value", "unit", "word"),
    [
        (1.0, "rad", 2**25),
        (-1.0, "rad", 2**32 - 2**25),
        (0.5, "V", 2**19),
        (math.nan, "V", 2**31),
        (1e9, "V", 2**31 - 1),
    ],
)
def test_values_become_words_and_words_values(value: float, unit: str, word: int) -> None:
    numbers = FixedNumbers(25, 20)
    assert numbers.to_word(value, unit) == word
    if abs(value) < 10.0:
        assert numbers.from_word(word, unit) == value
    assert math.isnan(numbers.from_word(2**31, unit))


def test_the_board_says_that_it_computes_in_fixed_point_and_refuses_a_host_that_does_not(
    image: tuple[FirmwareImage, str],
) -> None:
    table = ce150_table()
    with BoardClient.connect(image[1], table_digest=table.digest, numbers=numbers_of(table, "fixed")) as client:
        assert client.identity.arithmetic == "fixed"
        assert client.self_test() == 0
    with pytest.raises(BadInput, match=r"arithmetic: got fixed, expected float32"):
        BoardClient.connect(image[1], table_digest=table.digest, numbers=Float32Numbers())


def test_steps_through_the_line_are_those_of_the_host_bit_for_bit(image: tuple[FirmwareImage, str]) -> None:
    table = ce150_table()
    with BoardClient.connect(image[1], table_digest=table.digest, numbers=numbers_of(table, "fixed")) as client:
        law = LineLaw(client)
        result = compare(Stateless(host_law(table, "fixed")), law, fixed_sequences(table, 1000))
    assert law.arithmetic == "fixed"
    assert result.equality.steps >= 1000
    assert result.equality.mismatches == 0
    assert 0 < law.cycles_max < 2900


def test_an_image_with_a_software_division_is_refused_with_routine_and_caller() -> None:
    texts = generate_law(ce150_table(), "fixed")
    divided = texts["law.c"].replace("return (applied_V < 0) ? -ticks : ticks;", "return ticks / (safe_V + 3);")
    assert divided != texts["law.c"]
    with pytest.raises(BadInput, match=r"called by .*law_duty.*: fixed-point image: got __\w*div\w* linked in"):
        build_firmware({**texts, "law.c": divided})


def test_an_image_with_software_float_is_refused_and_the_float32_law_has_it() -> None:
    image = build_firmware(generate_law(ce150_table()))
    with pytest.raises(BadInput, match=r"fixed-point image: got \w*f\w* linked in"):
        refuse_soft_arithmetic(image)
    routines = [symbol for name, symbol in image.symbols.items() if name.startswith("__aeabi_f")]
    assert "law_step" in {name for routine in routines for name in callers_of(image.elf, routine.address)}
