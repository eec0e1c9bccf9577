"""What a diagnosis says of the firmware: whether it was run again, whether it did as its table says, and what that makes doubtful."""

from records.diagnosis import Firmware
from replay.columns import OF_THE_COLUMNS
from replay.firmware import CLEARED, NOT_FOUND
from replay.lone import ANGLE_LOGGED_LATE, LOGGED_LATE
from replay.variants import LATE_OUTPUT

# What a replay tells of the log, or of how the code was built, and not of what the firmware does.
_OF_THE_LOG = (*CLEARED, "begins_in_flight", "fused_multiply_add")
# What firmware and log cannot be told apart in: the plant may have been given other inputs than were logged.
_OF_THE_COLUMNS = (*OF_THE_COLUMNS, LOGGED_LATE, ANGLE_LOGGED_LATE, LATE_OUTPUT)
_ROWS_LACK = "rows that the log lacks"


def differs(firmware: Firmware | None) -> bool:
    """Whether the firmware itself did something else than its table says."""
    if firmware is None or not firmware.replayed or firmware.bit_exact:
        return False
    cause = firmware.cause or ""
    return cause.partition(":")[0] not in _OF_THE_LOG and _ROWS_LACK not in cause


def firmware_in_words(firmware: Firmware | None) -> str:
    """What running the controller's own code again showed, in one sentence."""
    if firmware is None:
        return "No log names a controller's table, so no controller's code was run again."
    again, cause = "Run again on the logged measurements, the controller's own code", _cause(firmware)
    if not firmware.replayed:
        return f"The controller's code was not run again, so nothing is known of the firmware: {cause or 'its table is not at hand'}."
    if firmware.bit_exact:
        return f"{again} gives every logged input to the bit: the firmware is cleared."
    if (firmware.cause or "").partition(":")[0] in CLEARED:
        return _closed(f"{again} agrees with all that the log holds: {cause}")
    at = "" if firmware.first_difference_s is None else f" first differs at {firmware.first_difference_s:g} s"
    return _closed(f"{again}{at or ' was compared'}: {cause or 'cause not found'}")


def firmware_first(firmware: Firmware | None) -> str:
    """What must be known of the firmware before anything is said of the plant; empty where it does as its table says."""
    if firmware is None or not differs(firmware):
        return ""
    if (firmware.cause or NOT_FOUND).startswith(NOT_FOUND):
        since = "" if firmware.first_difference_s is None else f" from {firmware.first_difference_s:g} s on"
        return (
            f"The log holds commands{since} that the firmware of its table does not compute: where they differ, "
            "a cause named in the plant is doubtful."
        )
    if firmware.cause is not None and firmware.cause.partition(":")[0].split(" + ")[0] in _OF_THE_COLUMNS:
        return (
            f"The log does not hold what the firmware of its table computes: {_cause(firmware)}. "
            "What seems to be amiss in the plant may come from that."
        )
    return f"The firmware does not do what its table says: {_cause(firmware)}. The plant is held against the inputs that were logged."


def _closed(sentence: str) -> str:
    return sentence if sentence.endswith("?") else f"{sentence}."


def _cause(firmware: Firmware) -> str:
    """The sentence of a cause, without its name for machines."""
    name, colon, sentence = (firmware.cause or "").partition(": ")
    return sentence if colon and " " not in name.replace(" + ", "") else firmware.cause or ""
