"""The generated text: same bytes, readable numbers, and C that stands alone on host and target."""

import itertools
import re
from dataclasses import replace

import numpy as np
import pytest

from codegen.law import generate_law
from codegen.law_frame import without_vanishing_powers
from codegen.numbers import c_float32
from codegen.operations import operation_count
from records.errors import BadInput
from records.table import ControllerTable
from tests.law_tables import ce150_table, changed_axis, dense_table
from tests.soak import sampled
from toolchain.host import STRICT_FLOAT_FLAGS, CText, build_shared
from toolchain.target import TARGET_FLAGS, compile_objects

PICKY = ("-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Wstrict-prototypes", "-Wdouble-promotion", "-Werror")


def test_same_table_gives_the_same_bytes_and_another_table_another_digest() -> None:
    assert generate_law(ce150_table()) == generate_law(ce150_table())
    other = changed_axis(ce150_table(), "azimuth", u_max_V=9.0)
    assert generate_law(other)["law.c"] != generate_law(ce150_table())["law.c"]
    assert other.digest in generate_law(other)["law.h"]


@pytest.mark.parametrize("value", [3.0, -0.0, 1.0 / 3.0, 1e-20, 2.0**-149, 3.4028235e38, 16777217.0, -1280.0])
def test_a_number_in_c_text_reads_back_to_the_same_float32(value: float) -> None:
    text = c_float32(value)
    assert re.fullmatch(r"-?\d+(\.\d+)?(e[+-]\d+)?f", text)
    assert "." in text or "e" in text
    assert np.float32(text[:-1]).view(np.uint32) == np.float32(value).view(np.uint32)


def test_every_coefficient_stands_in_the_text_exactly_once_rounded_to_float32() -> None:
    table = dense_table()
    initialisers = re.findall(r"\[\d\] = (\S+)f,", generate_law(table)["law.c"])
    found = np.sort([np.float32(text) for text in initialisers])
    wanted = [c for axis in (table.axes[0], table.axes[1]) for c in _coefficients(axis)]
    assert np.array_equal(found, np.sort(np.array(wanted, dtype=np.float32)))


@pytest.mark.parametrize("degree", sampled([0, 1, 3, 4, 7], keep=[0, 7]))
def test_any_polynomial_degree_compiles_for_the_target_without_a_warning(degree: int) -> None:
    texts = generate_law(ce150_table(degree=degree))
    compile_objects([CText(name, text) for name, text in texts.items()], flags=(*TARGET_FLAGS, *PICKY))


@pytest.mark.parametrize("time_constants_s", [(0.0, 0.0), (0.35, 0.0)])
def test_a_law_without_prefilter_compiles_for_host_and_target(time_constants_s: tuple[float, float]) -> None:
    table = changed_axis(ce150_table(), "elevation", prefilter_time_constant_s=time_constants_s[0])
    table = changed_axis(table, "azimuth", prefilter_time_constant_s=time_constants_s[1])
    sources = [CText(name, text) for name, text in generate_law(table).items()]
    compile_objects(sources, flags=(*TARGET_FLAGS, *PICKY))
    build_shared("law", sources, flags=(*STRICT_FLOAT_FLAGS, *PICKY))


def test_the_header_is_complete_alone_and_first_on_host_and_target() -> None:
    header = CText("law.h", generate_law(ce150_table())["law.h"])
    alone = CText(
        "alone.c", '#include "law.h"\n#include "law.h"\nint use(void);\nint use(void) { return LAW_PWM_TICKS; }\n'
    )
    compile_objects([header, alone], flags=(*TARGET_FLAGS, *PICKY))
    build_shared("header", [header, alone], flags=(*STRICT_FLOAT_FLAGS, *PICKY))


def test_no_double_no_division_and_no_heap_stand_in_the_law() -> None:
    text = re.sub(r"/\*.*?\*/", "", generate_law(ce150_table())["law.c"], flags=re.DOTALL)
    assert not re.search(r"\b(double|malloc|while|for|goto)\b", text)
    assert set(re.findall(r"/ \d+", text)) == {"/ 2"}  # of integers, in the duty
    assert all(number.endswith("f") for number in re.findall(r"\d+\.\d+(?:e[+-]\d+)?\w*", text))


def test_terms_that_are_zero_for_every_psi_cost_nothing() -> None:
    integrating, leaky = ce150_table(), changed_axis(ce150_table(), "elevation", p=((0.1, 0.0, 0.0, 0.1),) * 3)
    assert "elevation_p_0" not in generate_law(integrating)["law.c"]
    assert "elevation_p_0" in generate_law(leaky)["law.c"]
    assert operation_count(leaky).products == operation_count(integrating).products + 4


def test_an_unknown_arithmetic_is_refused_with_its_name() -> None:
    with pytest.raises(BadInput, match=r"got float16, expected .*float32"):
        generate_law(ce150_table(), "float16")


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"q_V_rad": ((0.0,),) * 4}, "every q is zero"),
        ({"q_V_rad": ((1e6,),) * 4}, "commands of up to"),
        ({"feedforward_V": (1e39,)}, "commands of up to"),
        ({"p": ((float("nan"),),) * 3}, "commands of up to nan"),
    ],
)
def test_a_table_that_cannot_fly_is_refused(change: dict[str, object], complaint: str) -> None:
    with pytest.raises(BadInput, match=complaint):
        generate_law(changed_axis(ce150_table(), "elevation", **change))


def test_a_sample_period_that_the_timer_cannot_count_is_refused() -> None:
    with pytest.raises(BadInput, match="whole microseconds"):
        generate_law(replace(ce150_table(), sample_period_s=0.01 / 3.0))


def test_generated_text_has_no_date_and_no_place() -> None:
    for text in generate_law(ce150_table()).values():
        assert not re.search(r"20\d\d-\d\d|/home|/work|/tmp", text)


def _coefficients(axis: object) -> list[float]:
    polynomials = itertools.chain(axis.q_V_rad, axis.p, ((a,) for a in axis.a), (axis.feedforward_V,))  # type: ignore[attr-defined]
    return [c for polynomial in polynomials for c in without_vanishing_powers(polynomial)]


def test_the_sample_period_is_whole_microseconds_in_the_header() -> None:
    table: ControllerTable = ce150_table()
    assert f"#define LAW_SAMPLE_PERIOD_US {round(table.sample_period_s * 1e6)} " in generate_law(table)["law.h"]
