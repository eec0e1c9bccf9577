"""The generated law when its own numbers are damaged: whatever its state or input, what it asks for stays inside the limits."""

import numpy as np
import pytest

from codegen.law import generate_law
from tests.law_tables import STATE_WORDS, ce150_table
from verification.host_law import HostLaw

TABLE = ce150_table()
U_M_V, U_T_V = (0.0, 10.0), (-10.0, 10.0)
WRONG = (np.nan, np.inf, -np.inf, 3e38, -3e38, 1e-40)


@pytest.fixture(scope="module")
def law() -> HostLaw:
    return HostLaw(generate_law(TABLE))


def bits(values: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(values, np.float32).view(np.uint32)


def flown(law: HostLaw, states: np.ndarray, inputs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Final states and outputs [steps, lanes, 2] in volts; every output is inside its limits."""
    states, outputs = law.run(states, inputs)
    volts = outputs.view(np.float32)
    for axis, (low, high) in enumerate((U_M_V, U_T_V)):
        assert np.all((volts[..., axis] >= low) & (volts[..., axis] <= high))  # false for NaN
    return states.view(np.float32), volts


def steady(law: HostLaw, lanes: int) -> np.ndarray:
    """States after a second of flight, once for each lane."""
    inputs = bits(np.tile([0.1, 0.2, 0.08, 0.19], (100, 1, 1)))
    states, _ = law.run(law.start(bits(np.array([[0.05, 0.1]]))), inputs)
    return np.repeat(states, lanes, axis=0)


def test_every_flipped_bit_of_its_state_leaves_outputs_inside_the_limits_and_no_nan_behind(law):
    lanes = 32 * STATE_WORDS
    states = steady(law, lanes)
    for lane in range(lanes):
        states[lane, lane // 32] ^= np.uint32(1 << lane % 32)
    after, _ = flown(law, states, bits(np.tile([0.1, 0.2, 0.08, 0.19], (300, lanes, 1))))
    assert np.all(np.isfinite(after))


@pytest.mark.parametrize("word", range(STATE_WORDS))
def test_no_number_in_its_state_is_too_wrong(law, word):
    states = steady(law, len(WRONG))
    states[:, word] = bits(np.array(WRONG))
    after, _ = flown(law, states, bits(np.tile([0.1, 0.2, 0.08, 0.19], (300, len(WRONG), 1))))
    assert np.all(np.isfinite(after))


@pytest.mark.parametrize("which", range(4))
def test_a_host_that_sends_no_number_for_one_sample_is_forgiven(law, which):
    """References and angles cross the line as raw words: a sound frame may hold anything."""
    inputs = np.tile([0.1, 0.2, 0.08, 0.19], (301, len(WRONG), 1))
    inputs[0, :, which] = WRONG
    after, _ = flown(law, steady(law, len(WRONG)), bits(inputs))
    assert np.all(np.isfinite(after))
