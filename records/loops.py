"""The loops that a law closes, by the names that plant, table, protocol and pages give to their parts: named here, derived elsewhere."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Loop:
    """One loop: its `axis`, the `symbol` of the axis' angle, the letter of its `rotor` and the `motor` that it drives.

    Columns bear their units: output psi_rad, reference psi_ref_rad, input u_M_V.
    """

    axis: str
    symbol: str
    rotor: str
    motor: str

    @property
    def output(self) -> str:
        """The measured angle."""
        return f"{self.symbol}_rad"

    @property
    def rate(self) -> str:
        """The angle's rate, a state of the plant."""
        return f"{self.symbol}_dot_rad_s"

    @property
    def reference(self) -> str:
        """What the angle is to be."""
        return f"{self.symbol}_ref_rad"

    @property
    def counts(self) -> str:
        """What the angle's encoder counts."""
        return f"{self.symbol}_counts"

    @property
    def rotor_speed(self) -> str:
        """The speed of the rotor between input and angle, a state of the plant."""
        return f"omega_{self.rotor}_rad_s"

    @property
    def input(self) -> str:
        """What the law commands."""
        return f"u_{self.rotor}_V"

    @property
    def duty(self) -> str:
        """What the command is on the board's PWM."""
        return f"duty_{self.motor}_ticks"


# In the order of the plant's outputs and inputs. The first angle is the one that the schedule goes by.
LOOPS = (Loop("elevation", "psi", "M", "main"), Loop("azimuth", "phi", "T", "tail"))
