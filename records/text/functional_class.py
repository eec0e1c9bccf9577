"""The functional class of a missing term, as the contract writes it: "torque(psi, sgn psi_dot) on elevation".

What the term is (a torque, a limit, an output's error ...), the signals that it depends on, and where it acts. This is the notation's one
reader: what somebody needs of a class is asked here, not looked for in its text.
"""

from dataclasses import dataclass

SIGN = "sgn "


@dataclass(frozen=True)
class Dependence:
    """A signal that a term depends on, or on the sign of which it depends."""

    signal: str
    by_sign: bool = False

    @property
    def text(self) -> str:
        """ "sgn psi_dot"."""
        return f"{SIGN}{self.signal}" if self.by_sign else self.signal


@dataclass(frozen=True)
class FunctionalClass:
    """A class: its `kind` ("torque", empty where the signal itself is amiss), what it depends on, and `acts` ("on elevation")."""

    kind: str
    depends: tuple[Dependence, ...]
    acts: str = ""

    @property
    def text(self) -> str:
        """The notation, which `parse_class` reads back."""
        depends = ", ".join(entry.text for entry in self.depends)
        return f"{self.kind}({depends}) {self.acts}".rstrip() if self.kind else f"{depends} {self.acts}".rstrip()


def parse_class(text: str) -> FunctionalClass:
    """A class from its notation; a text without brackets is one of no kind, whose words but for "on PLACE" are its signals."""
    kind, opened, rest = text.partition("(")
    if opened:
        inside, _, acts = rest.partition(")")
        return FunctionalClass(kind, _depends(inside), acts.strip())
    signals, on, place = text.partition(" on ")
    return FunctionalClass("", _depends(signals), f"on {place}" if on else "")


def _depends(text: str) -> tuple[Dependence, ...]:
    names = [name.strip() for name in text.split(",")]
    return tuple(Dependence(name.removeprefix(SIGN), name.startswith(SIGN)) for name in names)
