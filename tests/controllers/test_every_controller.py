"""What every row of the table holds: twin, host and target equal in all bits, one firmware, a digest of its own, total laws."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from controllers.table import CONTROLLERS
from rig.emulator.board import EmulatedBoard
from rig.flight.target_law import TargetLaw
from rig.programming.image import build_firmware, control_sources
from sim.loop import fly
from sim.manoeuvres import Leg, hop, manoeuvre
from tests.controllers.rows import ROWS, ce150, designed
from tests.soak import SOAK, sampled
from verification.equality import compare
from verification.host_law import HostLaw
from verification.stimuli import standard_stimuli

STEPS = 100_000 if SOAK else 5_000
FIRST = 250 if SOAK else 40  # of the samples of a lane: a twin in Python takes as long for many lanes as for one
TARGET_STEPS = 100_000 if SOAK else 500  # a quarter of a second of the emulated board a row, in a soak six
# Mean |error| on the hop: one step of 10 deg, one of 15 deg, in eight seconds. The PID's one set of gains is slow at every elevation.
TRUTH_DEG = dict.fromkeys(ROWS, 1.6) | {"pid": 3.0}


@pytest.mark.parametrize("name", ROWS)
def test_twin_and_host_are_equal_in_all_bits_of_many_steps(name: str) -> None:
    row, table = designed(name)
    twin, host = row.twin(table), HostLaw(row.generate(table))
    assert host.state_words == twin.state_words
    stimuli = standard_stimuli(table, 6 * STEPS, words=twin.state_words)
    result = compare(twin, host, [replace(entry, inputs=entry.inputs[:FIRST]) for entry in stimuli])
    assert (result.equality.mismatches, result.first_mismatch) == (0, None)
    assert result.equality.steps >= STEPS


@pytest.mark.parametrize("name", sampled(ROWS, keep=["lqg", "fuzzy"]))
def test_host_and_target_are_equal_and_the_board_names_the_table(name: str) -> None:
    row, table = designed(name)
    texts = row.generate(table)
    host = HostLaw(texts)
    target = TargetLaw(EmulatedBoard(build_firmware(texts).elf), state_words=host.state_words)
    result = compare(host, target, standard_stimuli(table, TARGET_STEPS, words=host.state_words))
    assert (result.equality.mismatches, result.first_mismatch) == (0, None)
    assert (host.self_test(), target.self_test()) == (0, 0)
    assert host.table_digest() == target.table_digest() == table.digest
    assert target.cycles_max < 640_000, "more than the 10 ms of a sample at 64 MHz"


def test_digests_tell_controllers_of_the_same_plant_apart() -> None:
    digests = {designed(name)[1].digest for name in ROWS}
    assert len(digests) == len(ROWS)


@pytest.mark.parametrize("name", ROWS)
def test_the_same_table_gives_the_same_bytes_and_a_changed_one_other_ones(name: str) -> None:
    row, table = designed(name)
    assert row.generate(table) == row.generate(table)
    assert f'"digest": "{table.digest}"' in row.text(table)


@pytest.mark.parametrize("name", sampled(ROWS, keep=["lqg", "fuzzy"]))
def test_the_self_test_notices_a_changed_law(name: str) -> None:
    row, table = designed(name)
    texts = dict(row.generate(table))
    changed = texts["law.c"].replace("finite_or(input->psi_rad,", "finite_or(input->psi_rad + 0.01f,")
    assert changed != texts["law.c"]
    assert HostLaw({**texts, "law.c": changed}).self_test() > 0


@pytest.mark.parametrize("name", sampled(ROWS, keep=["scheduled", "pid"]))
def test_float_law_and_twin_fly_the_same_flight(name: str) -> None:
    row, table = designed(name)
    manoeuvre = hop(ce150())
    exact, single = (fly(ce150(), law, manoeuvre) for law in (row.float_law(table), row.twin(table)))
    assert np.max(np.abs(exact.y - single.y)) < np.radians(0.3)  # a few encoder steps
    assert np.degrees(np.mean(np.abs(manoeuvre.reference_rad - single.y))) < TRUTH_DEG[name]


@pytest.mark.parametrize("name", sampled(ROWS, keep=["instantaneous", "lqg"]))
def test_a_flight_with_a_broken_state_comes_back_to_its_reference(name: str) -> None:
    # Truth: whatever the 32-bit words of the state are at the start, the last two of twenty seconds are within 2 deg.
    row, table = designed(name)
    rng = np.random.default_rng(3)
    still = manoeuvre("still", hop(ce150()).x0, 20.0, 0.01, ((Leg(0.0, -10.0),), (Leg(0.0, 0.0),)))
    for kind in range(3):
        law = _BrokenLaw(row.generate(table))
        law.wild = rng.integers(0, 2**32, (1, law.state_words), dtype=np.uint32)
        law.wild[:, :: kind + 1] = (0x7FC00000, 0x7F800000, 0xC61C4000)[kind]
        error_rad = (still.reference_rad - fly(ce150(), law, still).y)[-200:]
        assert np.degrees(np.max(np.abs(error_rad))) < 2.0, kind


class _BrokenLaw(HostLaw):
    """A compiled law that starts with whatever stands in `wild`."""

    wild: NDArray[np.uint32] | None = None

    def reset(self, *angles_rad: float) -> None:
        super().reset(*angles_rad)
        if self.wild is not None:
            self._state[:] = self.wild


def test_the_firmware_knows_no_controller() -> None:
    names = {word for name in CONTROLLERS for word in (name, name.upper())} - {"scheduled"}
    for source in control_sources():
        assert not names & set(source.read_text().replace("_", " ").split()), source.name
