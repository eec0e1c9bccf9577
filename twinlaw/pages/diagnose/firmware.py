"""What a diagnosis says of the firmware: whether it was run again, whether it did as its table says, and what that makes doubtful."""

from collections.abc import Sequence

from records.diagnosis import Firmware, LiesIn
from records.reasons import Note

KIND = "firmware"  # of notes: what running it again shows of one log


def amiss(firmware: Firmware | None) -> str:
    """What is amiss where firmware and log do not agree, in a few words; empty where they do."""
    if firmware is None or not firmware.differs:
        return ""
    if firmware.lies_in in (LiesIn.COLUMNS, LiesIn.UNEXPLAINED):
        return "the log does not hold what the firmware of its table computes"
    return "the firmware does not do as its table says"


def firmware_in_words(firmware: Firmware | None, notes: Sequence[Note] = ()) -> str:
    """What running the controller's own code again showed, in one sentence; of which log, where a note says the same of it."""
    if firmware is None:
        return "No log names a controller's table, so no controller's code was run again."
    again, cause = _again(firmware, notes), firmware.sentence
    if not firmware.replayed:
        return f"The controller's code was not run again, so nothing is known of the firmware: {cause or 'its table is not at hand'}."
    if firmware.bit_exact:
        return f"{again} gives every logged input to the bit: the firmware is cleared."
    if firmware.lies_in == LiesIn.LOG:
        return _closed(f"{again} agrees with all that the log holds: {cause}")
    return _closed(f"{again} {_compared(firmware)}: {cause or 'cause not found'}")


def firmware_behind_the_first(firmware: Firmware, notes: Sequence[Note]) -> str:
    """The same for a reader of `firmware_first`: without the cause that stands there."""
    if not firmware.differs or firmware.lies_in == LiesIn.UNEXPLAINED:
        return firmware_in_words(firmware, notes)
    return f"{_again(firmware, notes)} {_compared(firmware)}."


def beside_firmware(firmware: Firmware | None, notes: Sequence[Note]) -> list[Note]:
    """The notes without the one that says of a log what is said of the firmware."""
    return [note for note in notes if firmware is None or not _says_the_same(note, firmware)]


def _says_the_same(note: Note, firmware: Firmware) -> bool:
    return note.kind == KIND and note.said == f"{note.subject}: {firmware.sentence}"


def _again(firmware: Firmware, notes: Sequence[Note]) -> str:
    of = next((f" of {note.subject}" for note in notes if _says_the_same(note, firmware)), "")
    return f"Run again on the logged measurements{of}, the controller's own code"


def _compared(firmware: Firmware) -> str:
    at_s = firmware.first_difference_s
    return "was compared" if at_s is None else f"first differs at {at_s:g} s"


def firmware_first(firmware: Firmware | None) -> str:
    """What must be known of the firmware before anything is said of the plant; empty where it does as its table says."""
    if firmware is None or not firmware.differs:
        return ""
    if firmware.lies_in == LiesIn.UNEXPLAINED:
        since = "" if firmware.first_difference_s is None else f" from {firmware.first_difference_s:g} s on"
        return (
            f"The log holds commands{since} that the firmware of its table does not compute: where they differ, "
            "a cause named in the plant is doubtful."
        )
    if firmware.lies_in == LiesIn.COLUMNS:
        return (
            f"The log does not hold what the firmware of its table computes: {firmware.sentence}. "
            "What seems to be amiss in the plant may come from that."
        )
    return f"The firmware does not do what its table says: {firmware.sentence}. The plant is held against the inputs that were logged."


def _closed(sentence: str) -> str:
    return sentence if sentence.endswith("?") else f"{sentence}."
