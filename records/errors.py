"""The two ways in which a command can fail on purpose."""

from dataclasses import dataclass


@dataclass(eq=False)  # not frozen: a context manager that an exception passes through sets its traceback
class BadInput(Exception):
    """Input that cannot be used: what it is, where it stands, what was found, what was expected, what to do (exit status 2)."""

    what: str
    where: str
    got: str
    expected: str
    remedy: str

    def __str__(self) -> str:
        # A quantity without a unit ends in the space before it.
        got, expected = self.got.rstrip(), self.expected.rstrip()
        return f"{self.where}: {self.what}: got {got}, expected {expected}; {self.remedy}"


class VerificationFailed(Exception):
    """A check of the product, not of the input, did not hold (exit status 1)."""
