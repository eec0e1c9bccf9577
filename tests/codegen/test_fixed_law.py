"""The fixed-point law as text and as integers: formats that are proved, words that mean what the header says, equations that are exact."""

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from codegen.fixed.arithmetic import Scalars
from codegen.fixed.constants import fixed_constants, word_number
from codegen.fixed.equations import law_reset, law_step, state_from_words
from codegen.fixed.formats import MISSING, law_formats, value_of, word_of
from codegen.fixed.ranges import Interval, Intervals, prove_no_overflow
from codegen.fixed.twin import FixedTwin
from codegen.law import generate_law
from codegen.law_frame import LawInput
from records.errors import BadInput
from records.table import ControllerTable
from tests.law_tables import STATE_WORDS, ce150_table, changed_axis, dense_table
from tests.soak import sampled
from toolchain.host import STRICT_FLOAT_FLAGS, CText, build_shared
from toolchain.target import TARGET_FLAGS, compile_objects

PICKY = ("-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-Wshadow", "-Wstrict-prototypes", "-Werror")
TABLES = (ce150_table(), dense_table(), ce150_table(degree=5, prefilter_time_constant_s=0.0))


def test_same_table_gives_the_same_bytes_and_states_its_arithmetic() -> None:
    texts = generate_law(ce150_table(), "fixed")
    assert texts == generate_law(ce150_table(), "fixed")
    assert set(texts) == {"law.h", "law.c", "law_self_test.c"}
    assert "#define LAW_ARITHMETIC_CODE 1 " in texts["law.h"]
    assert ce150_table().digest in texts["law.h"]
    for text in texts.values():
        assert not re.search(r"20\d\d-\d\d|/home|/work|/tmp", text)


@pytest.mark.parametrize("degree", sampled([0, 1, 3, 4, 7], keep=[7]))
def test_any_degree_compiles_for_host_and_target_without_a_warning(degree: int) -> None:
    sources = [CText(name, text) for name, text in generate_law(ce150_table(degree=degree), "fixed").items()]
    compile_objects(sources, flags=(*TARGET_FLAGS, *PICKY))
    build_shared("law-fixed", sources, flags=(*STRICT_FLOAT_FLAGS, *PICKY))


@pytest.mark.parametrize("name", ["elevation", "azimuth"])
def test_a_law_without_one_prefilter_compiles(name: str) -> None:
    texts = generate_law(changed_axis(ce150_table(), name, prefilter_time_constant_s=0.0), "fixed")
    build_shared("law-fixed", [CText(*item) for item in texts.items()], flags=(*STRICT_FLOAT_FLAGS, *PICKY))


def test_no_float_no_division_no_loop_and_no_heap_stand_in_the_law() -> None:
    text = re.sub(r"/\*.*?\*/", "", generate_law(ce150_table(), "fixed")["law.c"], flags=re.DOTALL)
    assert not re.search(r"\b(float|double|int64_t|malloc|while|for|goto)\b", text)
    assert not re.search(r" [/%] |\d\.\d", text)


def test_an_even_schedule_needs_no_odd_power_and_a_vanishing_term_costs_nothing() -> None:
    text = generate_law(ce150_table(), "fixed")["law.c"]
    assert "azimuth_q_3" not in text
    azimuth = text[text.index("static int32_t azimuth_q_0") : text.index("static int32_t azimuth_a_0")]
    assert "schedule->x_2" in azimuth
    assert "schedule->x_1" not in azimuth


@pytest.mark.parametrize("table", TABLES)
def test_every_stored_word_of_hostile_steps_lies_within_its_proved_range(table: ControllerTable) -> None:
    proved = prove_no_overflow(table).ranges
    watched = _Watched(proved)
    law = fixed_constants(table, word_number)
    for state, given in _any_words(np.random.default_rng(4), 300):
        law_step(law, watched, state_from_words(law, state), LawInput.of(given))
        law_reset(law, watched, given[:2])
    assert watched.seen > 10_000
    assert max(max(-low, high) for low, high in proved.values()) < 2**31


def test_the_proof_refuses_what_could_leave_its_word_and_names_it() -> None:
    words = Intervals()
    with pytest.raises(BadInput, match=r"v_V.*words .*2147483648"):
        words.word("v_V", Interval(2**30, 2**30) + Interval(0, 2**30))
    with pytest.raises(BadInput, match="sums of products within 64"):
        Interval(0, 2**40) * Interval(0, 2**40)
    with pytest.raises(BadInput, match="short coefficient"):
        words.scaled_short(Interval(0, 2**15), Interval(0, 1))


def test_a_table_whose_numbers_no_word_can_hold_is_refused_with_the_way_out() -> None:
    """Limits of ten nanovolts next to coefficients of thousands of volts: no format has room for both."""
    table = ce150_table()
    for name in ("elevation", "azimuth"):
        table = changed_axis(table, name, u_min_V=-1e-8, u_max_V=1e-8, feedforward_V=(0.0,))
    with pytest.raises(BadInput, match=r"--arithmetic float32"):
        generate_law(table, "fixed")


@pytest.mark.parametrize(
    ("value", "places", "word"),
    [
        (1.5, 4, 24),
        (-1.5, 4, -24),
        (math.nan, 4, MISSING),
        (math.inf, 4, MISSING),
        (1e9, 20, 2**31 - 1),
        (-1e9, 20, 1 - 2**31),
    ],
)
def test_a_value_becomes_the_nearest_word_and_no_number_becomes_missing(value: float, places: int, word: int) -> None:
    assert word_of(value, places) == word


def test_a_word_reads_back_exactly() -> None:
    for word in (0, 1, -1, 12345, 2**31 - 1, 1 - 2**31):
        assert word_of(value_of(word, 25), 25) == word
    assert math.isnan(value_of(MISSING, 25))


def test_a_missing_measurement_or_reference_is_replaced_by_the_last_accepted_one() -> None:
    whole, torn = FixedTwin(ce150_table()), FixedTwin(ce150_table())
    for missing in (math.nan, math.inf, -math.inf):
        for twin in (whole, torn):
            twin.reset(0.1, 0.2)
            twin.step(0.12, 0.25, 0.11, 0.21)
        assert torn.step(missing, missing, missing, missing) == whole.step(0.12, 0.25, 0.11, 0.21)


def test_an_angle_beyond_the_range_of_its_word_counts_as_the_end_of_that_range() -> None:
    limit_rad = law_formats(ce150_table()).angle_limit_rad
    near, far = FixedTwin(ce150_table()), FixedTwin(ce150_table())
    for twin, angle_rad in ((near, limit_rad), (far, 9.9 * limit_rad)):
        twin.reset(0.0, 0.0)
        twin.step(0.0, 0.0, angle_rad, -angle_rad)
    assert near.step(0.1, 0.1, 0.0, 0.0) == far.step(0.1, 0.1, 0.0, 0.0)


def test_the_filtered_reference_arrives_exactly_and_stays() -> None:
    """At rest the filter must not stop short of the reference by what its gain rounds to nothing."""
    twin = FixedTwin(ce150_table())
    for reference_rad in (0.3, -0.123456, 0.7):
        words = [word_of(value, 25) for value in (reference_rad, 0.0, 0.0, 0.0)]
        state = law_reset(twin.law, Scalars(), (0, 0))
        for _ in range(1500):
            state, _output = law_step(twin.law, Scalars(), state, LawInput.of(words))
        held = max(twin.law.axes[0].reference_min_rad, min(twin.law.axes[0].reference_max_rad, words[0]))
        assert state.axes[0].reference_2_rad == held * 2 ** twin.law.axes[0].reference_doublings


def test_the_integrator_is_exact_whatever_the_number_of_steps() -> None:
    """q_0 alone, a constant error, no limits near: v must move by exactly n q_0 e, whatever n."""
    only_q_0 = {"q_V_rad": ((1.7e-7,), (0.0,), (0.0,), (0.0,)), "p": ((0.0,),) * 3, "prefilter_time_constant_s": 0.0}
    table = changed_axis(ce150_table(), "azimuth", feedforward_V=(0.0,), **only_q_0)
    twin = FixedTwin(table)
    steps, e_rad = 5_000, 0.25
    twin.reset(0.0, 0.0)
    for _ in range(steps):
        u_T_V = twin.step(0.0, e_rad, 0.0, 0.0)[1]
    (q_0,) = (term for term in twin.law.axes[1].terms if term.coefficient == "q_0")
    assert u_T_V == pytest.approx(steps * 1.7e-7 * e_rad, abs=2.0**-twin.formats.voltage_places)
    assert q_0.polynomial.constant >= 2**16


@pytest.mark.parametrize(
    ("u_V", "ticks"),
    [(0.0, 0), (10.0, 3200), (-10.0, -3200), (0.0015, 0), (0.0016, 1), (-0.0016, -1), (5.0, 1600), (99.0, 3200)],
)
def test_volts_become_the_nearest_pwm_tick_and_never_leave_full_scale(u_V: float, ticks: int) -> None:
    twin = FixedTwin(changed_axis(ce150_table(), "azimuth", u_safe_V=1.25))
    assert twin.duty(1, u_V) == ticks
    assert twin.duty(1, math.nan) == 400


def test_encoder_counts_become_the_nearest_angle() -> None:
    twin, table = FixedTwin(ce150_table()), ce150_table()
    for counts in (0, 1, -1, 455, -1480, 2607):
        assert abs(twin.angle_from_counts(1, counts) - counts * table.axes[1].resolution_rad) <= 2.0**-25
    limit_rad = law_formats(table).angle_limit_rad
    assert limit_rad <= twin.angle_from_counts(0, 2**31 - 1) < limit_rad + 2 * table.axes[0].resolution_rad


def test_a_range_of_references_on_one_side_of_zero_flies() -> None:
    table = changed_axis(ce150_table(), "elevation", reference_min_rad=0.1, reference_max_rad=0.7)
    twin = FixedTwin(replace(table, schedule=replace(table.schedule, min_rad=0.05)))
    twin.reset(0.0, 0.0)
    for _ in range(800):
        u_M_V, _ = twin.step(-0.5, 0.0, 0.1, 0.0)
    assert 0.0 < u_M_V < 10.0


class _Watched(Scalars):
    """Integers that are held against the proof, name by name."""

    def __init__(self, proved: dict[str, tuple[int, int]]) -> None:
        self.proved, self.seen = proved, 0

    def word(self, name: str, value: int) -> int:
        low, high = self.proved[name]
        assert low <= value <= high, f"{name}: {value} outside {low}..{high}"
        self.seen += 1
        return value

    def whole(self, total: int, places: int) -> tuple[bool, int]:
        assert -(2**63) <= total < 2**63
        fits, move = super().whole(total, places)
        return fits, self.word("move_V", move)


def _any_words(rng: np.random.Generator, count: int) -> Iterator[tuple[list[int], list[int]]]:
    """Words of all 32 bits, of all sizes, and of the outermost values."""
    for index in range(count):
        words: Any = rng.integers(-(2**31), 2**31, STATE_WORDS + 4, dtype=np.int64)
        if index % 3 == 1:
            words = words >> rng.integers(0, 32, len(words))
        if index % 3 == 2:
            words = rng.choice([-(2**31), 2**31 - 1, 0], len(words))
        yield words[:STATE_WORDS].tolist(), words[STATE_WORDS:].tolist()
