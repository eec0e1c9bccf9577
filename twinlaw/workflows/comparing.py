"""The stages behind `twinlaw compare`: each controller designed, generated, linked, verified on the board, and flown."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from codegen.protocol_source import protocol_source
from controllers.controller import Controller
from controllers.instantaneous import CONTROLLER as INSTANTANEOUS
from controllers.table import CONTROLLERS
from design.settings import read_settings
from records.errors import VerificationFailed
from records.files import write_atomic
from records.protocol import PROTOCOL
from records.table import changed_axis
from rig.emulator.board import EmulatedBoard
from rig.flight.target_law import TargetLaw
from rig.programming.image import build_firmware
from sim.bind import BoundPlant
from twinlaw.cli.console import stage
from twinlaw.pages.compare.comparison import BoardCost, Built, Compared, Wanted
from verification.comparison.eq26 import FormError, form_errors
from verification.comparison.flights import AXES, FILTERS, Each, Law, fly_figures, judge
from verification.equality import compare
from verification.flown_law import FlownLaw
from verification.host_law import HostLaw
from verification.stimuli import standard_stimuli


def compare_controllers(
    bound: BoundPlant, names: Sequence[str], wanted: Wanted, folder: Path, each: Each
) -> list[Compared]:
    """Everything of each controller; `each` flies the spread plants and effects, as `map` does."""
    built = [build_controller(bound, name, wanted, folder) for name in names]
    laws = {entry.row.name: entry.law for entry in built}
    judged = judge(bound, laws, read_settings(bound).sample_period_s, wanted.trial, each)
    return [Compared(**vars(entry), **vars(judged[entry.row.name])) for entry in built]


def build_controller(bound: BoundPlant, name: str, wanted: Wanted, folder: Path) -> Built:
    """One controller designed, verified, and flown through the figures; leaves its table, C and image in folder/NAME."""
    row = CONTROLLERS[name]
    with stage(f"{name}: designing"):
        table = row.design(bound, read_settings(bound))
        texts = row.generate(table)
    place = folder / name
    write_atomic(place / "controller.json", row.text(table))
    for file, text in {**texts, **protocol_source(PROTOCOL)}.items():
        write_atomic(place / "generated" / file, text)
    with stage(f"{name}: building the firmware"):
        image = build_firmware(texts, place)
    twin, host = row.twin(table), HostLaw(texts)
    target = TargetLaw(EmulatedBoard(image.elf), state_words=twin.state_words)
    stimuli = standard_stimuli(table, wanted.steps, words=twin.state_words)
    with stage(f"{name}: stepping twin, host and target side by side"):
        equality = tuple(compare(one, other, stimuli).equality for one, other in ((twin, host), (host, target)))
        mismatches = host.self_test() + target.self_test()
    cost = BoardCost(
        cycles_max=target.cycles_max,
        stack_bytes=target.stack_bytes,
        flash_bytes=image.sizes.flash_bytes,
        ram_bytes=image.sizes.ram_bytes,
    )
    with stage(f"{name}: flying the papers' manoeuvres"):
        flights = fly_figures(bound, FlownLaw(texts), table.sample_period_s)
    figures = {figure: flown.merits() for figure, flown in flights.items()}
    law = Law(texts, {share: _filtered(bound, row, table, share) for share in FILTERS})
    return Built(row, law, table.digest, equality, mismatches, cost, flights, figures)


def _filtered(bound: BoundPlant, row: Controller, table: Any, share: float) -> Mapping[str, str]:
    """The controller's texts behind another reference filter, in shares of the plant file's time constants."""
    settings = read_settings(bound)
    for axis in AXES:
        time_constant_s = share * settings.axis(axis).prefilter_time_constant_s
        table = changed_axis(table, axis, prefilter_time_constant_s=time_constant_s)
    return row.generate(table)


def eq26_errors(bound: BoundPlant, names: Sequence[str]) -> Mapping[tuple[str, str], FormError]:
    """Eq (26) in float32, the paper's form and the board's, by form and axis; nothing where the controller that solves it is left out."""
    if INSTANTANEOUS.name not in names:
        return {}
    with stage("solving eq (26) in float32 over the whole range"):
        settings = read_settings(bound)
        return form_errors(bound, settings, INSTANTANEOUS.design(bound, settings))


def demand_equal(rows: Sequence[Compared]) -> None:
    """Raise VerificationFailed naming every check that did not hold."""
    failures = [text for row in rows for text in row.failures]
    if failures:
        raise VerificationFailed("; ".join(failures))
