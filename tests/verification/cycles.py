"""Cycles of one control step on the emulated board, by what the law is given.

`.venv/bin/python -m tests.verification.cycles` prints the table of docs/proofs.md, for plants/ce150.toml.
"""

from collections.abc import Iterator
from pathlib import Path

from codegen.law import generate_law
from records.table import ControllerTable
from rig.emulator.board import EmulatedBoard
from rig.image import build_firmware
from rig.target_law import TargetLaw
from twinlaw.arithmetics import BY_NAME
from twinlaw.stages import design_controller

STEPS = 100_000
# From rest, references and angles within their ranges and beyond; the others set states, or bits, that no flight has.
FLOWN = ("reference jumps", "saturation")


def cycles(table: ControllerTable, arithmetic: str, steps: int = STEPS) -> Iterator[tuple[str, int, int]]:
    """Name of each stimulus of the equality checks, least and most cycles of a step under it."""
    elf = build_firmware(generate_law(table, arithmetic)).elf
    for stimulus in BY_NAME[arithmetic].stimuli(table, steps):
        law = TargetLaw(EmulatedBoard(elf), arithmetic)
        law.run(law.start(stimulus.angles) if stimulus.states is None else stimulus.states, stimulus.inputs)
        yield stimulus.name, law.cycles_min, law.cycles_max


def told(table: ControllerTable) -> str:
    """The table of docs/proofs.md."""
    lines = ["| arithmetic | given | least | most |", "|---|---|---|---|"]
    for arithmetic in BY_NAME:
        lines += [f"| {arithmetic} | {name} | {least} | {most} |" for name, least, most in cycles(table, arithmetic)]
    return "\n".join(lines)


if __name__ == "__main__":
    print(told(design_controller(Path("plants/ce150.toml")).table))
