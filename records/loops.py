"""The loops that a law closes, by the names that plant, table, protocol and pages give to their parts: named here, derived elsewhere."""

from dataclasses import dataclass

MOST_LOOPS = 4


@dataclass(frozen=True)
class Pins:
    """Where a loop hangs on a board: both inputs of its `encoder`, the `pwm` of its driver, and the driver's `direction`, by their names.

    The direction is high for negative inputs; None is a driver that turns one way only.
    """

    encoder: tuple[str, str]
    pwm: str
    direction: str | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """All of them."""
        return (*self.encoder, self.pwm, *([] if self.direction is None else [self.direction]))


@dataclass(frozen=True)
class Loop:
    """One loop: its `axis`, the columns of the measured angle `output` [rad] and of the commanded `input` [V], the `motor` driven.

    Columns bear their units: output psi_rad, reference psi_ref_rad, input u_M_V. A loop without `pins` flies with the host in the loop.
    """

    axis: str
    output: str
    input: str
    motor: str
    pins: Pins | None = None

    @property
    def symbol(self) -> str:
        """The angle without its unit."""
        return self.output.removesuffix("_rad")

    @property
    def voltage(self) -> str:
        """The input without its unit."""
        return self.input.removesuffix("_V")

    @property
    def reference(self) -> str:
        """What the angle is to be."""
        return f"{self.symbol}_ref_rad"

    @property
    def counts(self) -> str:
        """What the angle's encoder counts."""
        return f"{self.symbol}_counts"

    @property
    def duty(self) -> str:
        """What the command is on the board's PWM."""
        return f"duty_{self.motor}_ticks"


# The helicopter's, in the order of the plant's outputs and inputs.
LOOPS = (
    Loop("elevation", "psi_rad", "u_M_V", "main", Pins(("PA0", "PA1"), "PA8", "PB0")),
    Loop("azimuth", "phi_rad", "u_T_V", "tail", Pins(("PA6", "PA7"), "PA9", "PB1")),
)


def has_pins(loops: tuple[Loop, ...]) -> bool:
    """Whether a board has an encoder and an output for each of `loops`; others fly with the host in the loop alone."""
    return all(loop.pins is not None for loop in loops)
