"""Bounds of programs counted by hand: exact where one path is dearest, refused where there is no bound."""

from collections.abc import Iterator

import pytest

from records.errors import BadInput, VerificationFailed
from rig.emulator.board import EmulatedBoard
from tests.verification.static_bound.static_programs import INSTRUCTIONS, RETURN_CYCLES, instruction_name, program
from verification.static_bound import LoopBound, exploration, static_bound, thumb_cycles

SCRATCH = 0x20000100


@pytest.fixture(scope="module")
def elf() -> bytes:
    return program().read_bytes()


def three_counts(elf: bytes) -> Iterator[tuple[str, int, int, int]]:
    """Per instruction: cycles of the core's manual, of the emulated board, of the static table; each with its return."""
    board = EmulatedBoard(elf)
    for index, (text, cycles) in enumerate(INSTRUCTIONS.items()):
        stated = cycles if "pc}" in text else cycles + RETURN_CYCLES
        counted = board.call(instruction_name(index), 0, 1, 0, SCRATCH).cycles
        yield text, stated, counted, static_bound(elf, instruction_name(index)).cycles_bound


def test_each_instruction_costs_what_manual_and_emulated_board_say(elf: bytes) -> None:
    assert [entry for entry in three_counts(elf) if not entry[1] == entry[2] == entry[3]] == []


@pytest.mark.parametrize("cost_class", ["_TWO", "_THREE", "_MULTIPLE"])
def test_a_class_dropped_from_the_cycle_table_is_noticed(
    elf: bytes, monkeypatch: pytest.MonkeyPatch, cost_class: str
) -> None:
    monkeypatch.setattr(thumb_cycles, cost_class, frozenset())
    assert any(bound < counted for _, _, counted, bound in three_counts(elf))


# Cycles counted by hand from the programs' text, stack from their PUSH and SUB.
EXACT = {
    "empty": (2, 0),
    "branching": (1 + 1 + 3 + 1 + 2, 0),
    "excluding": (1 + 1 + 3 + 3 + 1 + 2 + 2, 0),
    "ten_passes": (1 + 10 * 2 + 9 * 2 + 1 + 2, 0),
    "nested_loops": (1 + 5 * (1 + 7 + 6 * 2 + 1 + 1) + 4 * 2 + 1 + 2, 0),
    "at_most_eight_passes": (3 + 8 + 7 * 2 + 1 + 2, 0),
    "inner": (5 + 1 + 1 + 7, 40),
    "middle": (2 + 1 + 3 + 14 + 1 + 4, 8 + 40),
    "outer": (3 + (3 + 2) + (3 + 25) + 1 + 1 + 5, 8 + 100),
    "leaving": (3 + 2 + 2 + 1 + 2 + 14, 40),
    "by_known_pointer": (2 + 2 + 2 + 2 + 4, 4),
}


@pytest.mark.parametrize("function", EXACT)
def test_bound_is_the_hand_count_where_the_dearest_path_is_plain(elf: bytes, function: str) -> None:
    bound = static_bound(elf, function)
    assert (bound.cycles_bound, bound.stack_bytes) == EXACT[function]
    assert bound.cycles_bound_wait_states > bound.cycles_bound


def test_path_splits_the_bound_by_function_and_loops_name_their_passes(elf: bytes) -> None:
    outer = static_bound(elf, "outer")
    assert sum(share.cycles for share in outer.path) == outer.cycles_bound
    shares = {share.function: (share.calls, share.cycles) for share in outer.path}
    assert shares == {"outer": (1, 16), "inner": (1, 14), "middle": (1, 11), "empty": (1, 2)}
    assert [(loop.function, loop.passes) for loop in static_bound(elf, "nested_loops").loops] == [
        ("nested_loops", 5),
        ("nested_loops", 7),
    ]


def test_a_switch_through_a_table_costs_what_its_dearest_case_does(elf: bytes) -> None:
    board = EmulatedBoard(elf)
    measured = [board.call("chosen", x, 3) for x in range(9)]
    bound = static_bound(elf, "chosen")
    assert bound.cycles_bound == max(call.cycles for call in measured)
    assert bound.stack_bytes == max(call.stack_bytes for call in measured)


def test_a_frame_too_large_for_one_instruction_is_followed(elf: bytes) -> None:
    measured = EmulatedBoard(elf).call("large_frame", 7)
    bound = static_bound(elf, "large_frame")
    assert (bound.cycles_bound, bound.stack_bytes) == (measured.cycles, measured.stack_bytes)
    assert bound.stack_bytes > 4 * 300


@pytest.mark.parametrize(
    ("function", "said"),
    [
        ("calling_itself", "calling_itself -> by_another -> calling_itself"),
        ("passes_by_argument", "passes_by_argument: no bound found for the loop at 0x"),
        ("by_pointer", "by_pointer: the call at 0x"),
        ("sleeping", "sleeping: wfi at 0x"),
        ("of_any_size", "of_any_size: the stack frame"),
        ("into_data", "run into data"),
    ],
)
def test_what_has_no_bound_is_refused_by_name_and_place(
    elf: bytes, monkeypatch: pytest.MonkeyPatch, function: str, said: str
) -> None:
    monkeypatch.setattr(exploration, "MOST_PASSES", 256)  # a sixteenth: all of them take half a second
    with pytest.raises(VerificationFailed, match=said):
        static_bound(elf, function)


def test_a_stated_loop_bound_is_used_and_its_reason_kept(elf: bytes) -> None:
    stated = LoopBound("passes_by_argument", 0, 20, "callers count to 20")
    bound = static_bound(elf, "passes_by_argument", (stated,))
    assert bound.cycles_bound == 20 + 19 * 2 + 1 + 2
    assert [(loop.passes, loop.reason) for loop in bound.loops] == [(20, "callers count to 20")]


@pytest.mark.parametrize("content", [b"", b"\x7fELF nothing else", b"MZ" + bytes(200)])
def test_what_is_no_image_is_refused(content: bytes) -> None:
    with pytest.raises(BadInput, match="ELF"):
        static_bound(content, "law_step")


def test_an_unknown_function_is_refused_by_name(elf: bytes) -> None:
    with pytest.raises(BadInput, match="no_such_function"):
        static_bound(elf, "no_such_function")
