"""Constants that decide something, each with its unit, its reason, and the data that set it: numbers that can be asked why."""

from collections.abc import Iterator, Mapping

UNRECORDED = "none on record: reasoned when written"


class Decides:
    """What is known of such a constant beside its value."""

    unit: str
    reason: str
    data: str

    def _told(self, unit: str, reason: str, data: str) -> None:
        self.unit, self.reason, self.data = unit, reason, data


class Limit(Decides, float):
    """A real number that decides; it computes as the float that it is."""

    def __new__(cls, value: float, unit: str, reason: str, data: str = UNRECORDED) -> "Limit":
        """`value` in `unit`."""
        number = super().__new__(cls, value)
        number._told(unit, reason, data)
        return number

    def __getnewargs__(self) -> tuple[float, str, str, str]:  # type: ignore[override]
        return float(self), self.unit, self.reason, self.data


class Count(Decides, int):
    """A whole number that decides; it computes as the int that it is."""

    def __new__(cls, value: int, unit: str, reason: str, data: str = UNRECORDED) -> "Count":
        """So many `unit`."""
        number = super().__new__(cls, value)
        number._told(unit, reason, data)
        return number

    def __getnewargs__(self) -> tuple[int, str, str, str]:  # type: ignore[override]
        return int(self), self.unit, self.reason, self.data


class Limits(Decides, tuple[float, ...]):
    """Several numbers that decide together."""

    def __new__(cls, values: tuple[float, ...], unit: str, reason: str, data: str = UNRECORDED) -> "Limits":
        """`values`, each in `unit`."""
        numbers = super().__new__(cls, values)
        numbers._told(unit, reason, data)
        return numbers

    def __getnewargs__(self) -> tuple[tuple[float, ...], str, str, str]:
        return tuple(self), self.unit, self.reason, self.data


class Counts(Decides, tuple[int, ...]):
    """Several whole numbers that decide together."""

    def __new__(cls, values: tuple[int, ...], unit: str, reason: str, data: str = UNRECORDED) -> "Counts":
        """So many `unit` each."""
        numbers = super().__new__(cls, values)
        numbers._told(unit, reason, data)
        return numbers

    def __getnewargs__(self) -> tuple[tuple[int, ...], str, str, str]:
        return tuple(self), self.unit, self.reason, self.data


def deciding(names: Mapping[str, object]) -> Iterator[tuple[str, Decides]]:
    """Those of a module's names that decide something, in its order: `deciding(vars(module))`."""
    return ((name, value) for name, value in names.items() if isinstance(value, Decides))
