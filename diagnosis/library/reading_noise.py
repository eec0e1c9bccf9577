"""Errors of readings that are alike from row to row, as those of an observer or a filter are: a state of every filter for each output.

(1)  y = h(x) + c + white noise,  c' = -c / T + white noise of intensity 2 s^2 / T

an Ornstein-Uhlenbeck process of standard deviation s and correlation time T (Bar-Shalom, Li and Kirubarajan, Estimation with Applications
to Tracking and Navigation, 2001, section 8.5: coloured measurement noise by an augmented state).
"""

from dataclasses import dataclass, replace

from sim.composition.switch import sleeping
from sim.edits import with_state
from sim.model import Model, ParameterSpec, symbol


@dataclass(frozen=True)
class ReadingNoise:
    """Of one output: standard deviation `sd`, in the output's unit, and correlation time `time_s`."""

    sd: float
    time_s: float

    @property
    def intensity(self) -> float:
        """Of the noise on the error's rate, in squares of the output's unit a second."""
        return 2.0 * self.sd**2 / self.time_s


def state_of(output: str) -> str:
    """The state that is an output's error."""
    return f"{output}_error"


def time_of(output: str) -> str:
    """The parameter that is the correlation time of an output's error."""
    return f"{output}_error_T"


def switch_of(output: str) -> str:
    """The parameter that is 1 where an output has such an error."""
    return f"{output}_error_on"


def with_reading_noise(model: Model) -> Model:
    """The model with eq (1) on each output, its noise left to the filter; each error stands still and is not felt while its switch is 0."""
    for output in model.outputs:
        time_s, on = ParameterSpec(time_of(output), 1, "s"), ParameterSpec(switch_of(output), 1, "1")
        error, T, felt = symbol(state_of(output)), time_s.symbols[0], on.symbols[0]
        before = model
        model = replace(model, parameters=(*model.parameters, time_s, on), switches=(*model.switches, felt))
        model = with_state(model, error, -error / T)
        model = replace(model, outputs={**model.outputs, output: model.outputs[output] + felt * error})
        model = sleeping(before, model, felt)
    return model
