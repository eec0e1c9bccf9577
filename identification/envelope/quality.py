"""How good models over the envelope are, by the one rule of records.quality."""

from identification.envelope.check import FINAL, Check
from identification.envelope.study import Study
from records.quality import MARGINS, Colour, Look, Quality, flag


def envelope_quality(found: Study) -> Quality:
    """Each signal of each free run, starts and trims tuned; a flag for runs that leave the margins within three seconds, and notes."""
    runs = [look for check in found.checks for look in check_looks(check)]
    notes = [f"{entry.condition.name}: {note}" for entry in found.conditions for note in entry.notes]
    return Quality((*runs, *(flag(note) for note in (*notes, *found.unused))))


def check_looks(check: Check, how: str = FINAL) -> list[Look]:
    """Signal by signal, and the three-second rule."""
    lost = len(check.data.x) - check.held[how]
    early = [
        flag(f"{check.name}: outside the margins within three seconds in {lost} of {len(check.data.x)}", Colour.RED)
    ]
    return [
        *(MARGINS.look(f"{match.signal} of {check.name}", match.outside_percent) for match in check.states[how]),
        *(early if lost else []),
    ]
