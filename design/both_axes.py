"""A record that has one entry for each of the helicopter's axes."""

from typing import Generic, TypeVar

A = TypeVar("A")


class BothAxes(Generic[A]):
    """Fields called as the axes."""

    elevation: A
    azimuth: A

    def axis(self, name: str) -> A:
        """The entry of the axis called `name`."""
        return {"elevation": self.elevation, "azimuth": self.azimuth}[name]
