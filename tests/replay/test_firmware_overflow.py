"""Flights of firmwares with integers that are too narrow: what wraps and what saturates is named, with its place and its range."""

from collections.abc import Callable

import numpy as np
import pytest

from replay.firmware import FirmwareReplay, replay_firmware
from sim.loop import Controller
from tests.law_tables import ce150_table
from tests.replay.firmware_flights import Command, Lossy, Wrapped, edited_law, flown, own, rows_of, stale
from tests.soak import sampled
from verification.host_law import host_law

TABLE = ce150_table()
STEP_RAD = TABLE.axes[1].resolution_rad
COMMAND = "const law_number u_V = v_V + u_ff_V;"


def _wrapped(value: float, low: float, span: float) -> float:
    return float(value - span * np.floor((value - low) / span))


def _as_integer(value: float, unit: float, bits: int, to: Callable[[float], int] = round) -> float:
    """The value in whole units, in a signed integer of so many bits that wraps round."""
    half = 2 ** (bits - 1)
    return ((to(value / unit) + half) % (2 * half) - half) * unit


def _saturated(value: float, unit: float, bits: int) -> float:
    half = 2 ** (bits - 1)
    return max(-half, min(half - 1, round(value / unit))) * unit


def _behind(main: Callable[[float], float], tail: Callable[[float], float], law: Controller | None = None) -> Wrapped:
    """The table's law, each of its outputs changed."""

    def after(k: int, sent: list[Command]) -> Command:
        return main(sent[k][0]), tail(sent[k][1])

    return Wrapped(host_law(TABLE) if law is None else law, after=after)  # type: ignore[arg-type]


def _same(value: float) -> float:
    return value


def _wraps_at_6_V(law: Controller | None = None) -> Wrapped:
    return _behind(lambda u: _wrapped(u, -6.0, 12.0), _same, law)


def _counted(axis: int, change: Callable[[int], int]) -> Wrapped:
    """The table's law, the whole counts of one angle changed before it sees them."""

    def before(k: int, given: list[tuple[float, float, float, float]]) -> tuple[float, float, float, float]:
        numbers = list(given[k])
        numbers[2 + axis] = change(round(numbers[2 + axis] / STEP_RAD)) * STEP_RAD
        return numbers[0], numbers[1], numbers[2], numbers[3]

    return Wrapped(host_law(TABLE), before)  # type: ignore[arg-type]


def _told(controller: Controller) -> FirmwareReplay:
    return replay_firmware(flown(controller), TABLE)


WRAPPING = [
    (lambda u: _wrapped(u, -7.3, 14.6), _same, "u_M_V wraps round at +-7.3 V"),
    (lambda u: _wrapped(u, 0.0, 8.0), _same, "u_M_V wraps round from 8 V to 0 V"),
    (_same, lambda u: _wrapped(u, -1.0, 4.0), "u_T_V wraps round from 3 V to -1 V"),
    (_same, lambda u: _wrapped(u, 0.0, 10.0), "u_T_V wraps round from 10 V to 0 V"),
]


@pytest.mark.parametrize(("main", "tail", "words"), sampled(WRAPPING, keep=WRAPPING[2:3]))
def test_an_output_that_wraps_is_named_with_its_range(
    main: Callable[[float], float], tail: Callable[[float], float], words: str
) -> None:
    found = _told(_behind(main, tail))
    assert (found.bit_exact, found.cause, found.incidents) == (False, "output_wraps", ())
    assert words in (found.sentence or "")
    assert "integer overflow" in (found.sentence or "")


NARROW = [
    (2.0**-12, 16, round, "8 V"),
    (2.0**-12, 16, int, "8 V"),
    (1e-4, 16, round, "3.2768 V"),
    (10.0 / 255.0, 8, round, "5.019608 V"),
    (10.0 / 3200.0, 12, int, "6.4 V"),
]


@pytest.mark.parametrize(("unit_V", "bits", "to", "end_V"), sampled(NARROW, keep=NARROW[4:]))
def test_an_output_in_a_narrow_integer_is_named_with_its_range_and_its_step(
    unit_V: float, bits: int, to: Callable[[float], int], end_V: str
) -> None:
    found = _told(_behind(*[lambda u: _as_integer(u, unit_V, bits, to)] * 2))
    assert found.cause == "output_wraps"
    assert f"+-{end_V}" in (found.sentence or "")
    assert f"steps of {unit_V:.6g} V" in (found.sentence or "")


def test_an_output_that_saturates_is_told_from_one_that_wraps() -> None:
    unit_V = 1.6 * 2.0**-12
    found = _told(_behind(*[lambda u: _saturated(u, unit_V, 15)] * 2))
    assert found.cause == "output_saturates"
    assert "u_max_V 6.39961 V" in (found.sentence or "")
    assert _told(_behind(lambda u: min(u, 6.0), _same)).cause == "limited_behind_the_law"


WITHIN = [
    ("v_V -= 2.0f * __builtin_floorf((v_V + 1.0f) / 2.0f);", "sum_wraps", "sum wraps round at +-1 V"),
    ("v_V -= 5.0f * __builtin_floorf((v_V + 2.5f) / 5.0f);", "sum_wraps", "sum wraps round at +-2.5 V"),
    ("v_V = (v_V > 1.0f) ? 1.0f : (v_V < -1.0f) ? -1.0f : v_V;", "sum_saturates", "sum saturates at +-1 V"),
    (
        "v_V = (v_V > 4095.0f / 4096.0f) ? 4095.0f / 4096.0f : (v_V < -1.0f) ? -1.0f : v_V;",
        "sum_saturates",
        "sum saturates at -1 V and 0.9997559 V",
    ),
]


@pytest.mark.parametrize(("change", "cause", "words"), sampled(WITHIN, keep=[WITHIN[1], WITHIN[3]]))
def test_a_sum_within_the_law_that_wraps_or_saturates_is_named(change: str, cause: str, words: str) -> None:
    found = _told(edited_law(COMMAND, f"{change} {COMMAND}"))
    assert (found.bit_exact, found.cause) == (False, cause)
    assert words in (found.sentence or "")


def test_a_command_that_wraps_before_its_limits_is_named() -> None:
    wraps = "const law_number raw_V = v_V + u_ff_V;"
    wraps += " const law_number u_V = raw_V - 16.0f * __builtin_floorf((raw_V + 8.0f) / 16.0f);"
    found = _told(edited_law(COMMAND, wraps))
    assert found.cause == "sum_wraps"
    assert "command before its limits wraps round at +-8 V" in (found.sentence or "")


COUNTS = [
    (0, lambda n: (n + 128) % 256 - 128, "angle_wraps", "elevation counts wrap round (signed) in 8 bits"),
    (1, lambda n: (n + 512) % 1024 - 512, "angle_wraps", "azimuth counts wrap round (signed) in 10 bits"),
    (1, lambda n: n % 65536, "angle_wraps", "azimuth counts wrap round (unsigned) in 16 bits"),
    (1, lambda n: max(-512, min(511, n)), "angle_saturates", "azimuth counts saturate (signed) in 10 bits"),
]


@pytest.mark.parametrize(("axis", "change", "cause", "words"), sampled(COUNTS, keep=[COUNTS[0], *COUNTS[2:]]))
def test_encoder_counts_in_a_narrow_integer_are_named(
    axis: int, change: Callable[[int], int], cause: str, words: str
) -> None:
    found = _told(_counted(axis, change))
    assert (found.bit_exact, found.cause) == (False, cause)
    assert words in (found.sentence or "")


@pytest.mark.soak
def test_a_wrap_beside_another_cause_is_named_with_it() -> None:
    assert _told(_wraps_at_6_V(Wrapped(host_law(TABLE), stale((2, 3))))).cause == "stale_sample + output_wraps"


@pytest.mark.soak
def test_a_wrap_beside_losses_is_named_with_them() -> None:
    dropping = Lossy(_wraps_at_6_V(), lambda k: "output" if k % 97 == 96 else None)
    assert _told(dropping).cause == "output_wraps + dropped_frame"
    log = flown(_wraps_at_6_V())
    found = replay_firmware(rows_of(log, ~np.isin(np.arange(len(log.t_s)), [300, 900])), TABLE)
    assert found.cause == "output_wraps + sample_not_logged"


BEHIND = [_wraps_at_6_V, lambda law: _behind(lambda u: -u, lambda u: -u, law)]


@pytest.mark.soak
@pytest.mark.parametrize("controller", sampled(BEHIND, keep=BEHIND[:1]))
def test_what_lies_behind_a_law_in_fixed_point_is_named(controller: Callable[[Controller], Controller]) -> None:
    found = _told(controller(host_law(TABLE, "fixed")))
    assert found.cause in ("output_wraps", "output_sign")
    assert "in fixed point and" in (found.sentence or "")


@pytest.mark.soak
@pytest.mark.parametrize(
    ("off_V", "cause"),
    [(5.3, "not_found"), pytest.param(8.0, "output_wraps", marks=pytest.mark.soak)],  # a range that integers have
)
def test_one_sample_that_is_off_proves_no_range_but_of_integers(off_V: float, cause: str) -> None:
    log = own()
    log.u[int(np.argmax(log.u[:, 0])), 0] -= off_V
    assert replay_firmware(log, TABLE).cause == cause


@pytest.mark.soak
def test_differences_that_are_no_multiples_of_one_range_are_no_wrap() -> None:
    log = own()
    rows = log.u[:, 0] > 6.0
    log.u[rows, 0] -= np.random.default_rng(4).uniform(4.0, 12.0, int(rows.sum()))
    assert replay_firmware(log, TABLE).cause == "not_found"
