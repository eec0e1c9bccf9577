"""The stages behind `twinlaw compare`: each controller designed, generated, linked, verified on the board, and flown."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from codegen.protocol_source import protocol_source
from controllers.controller import Controller
from controllers.equations.equation_controller import EquationController
from controllers.instantaneous import CONTROLLER as INSTANTANEOUS
from controllers.settling import demand_settling
from controllers.table import CONTROLLERS
from design.settings import read_settings
from records.errors import BadInput, VerificationFailed
from records.files import write_atomic
from records.law_table import LawTable
from records.protocol import protocol_of
from records.table import changed_axis
from rig.emulator.board import EmulatedBoard
from rig.flight.target_law import TargetLaw
from rig.programming.image import build_firmware
from sim.bind import BoundPlant
from twinlaw.cli.console import stage
from twinlaw.pages.compare.comparison import BoardCost, Built, Compared, Wanted
from verification.comparison.eq26 import FormError, form_errors
from verification.comparison.flights import FILTERS, Each, Law, flown_law, fly_figures, judge
from verification.comparison.tuning import tune, tuned_section
from verification.equality import compare
from verification.host_law import HostLaw
from verification.stimuli import standard_stimuli


def design_controllers(
    bound: BoundPlant, names: Sequence[str]
) -> tuple[dict[str, Any], dict[str, str], dict[str, str]]:
    """The tables of those that can be designed for this plant; why the others cannot; why some do not settle there; each by name.

    Raises BadInput where none can be designed.
    """
    tables, refused, unsettled, settings = {}, {}, {}, read_settings(bound)
    for name in names:
        row = CONTROLLERS[name]
        with stage(f"{name}: designing"):
            try:
                tables[name] = row.design(bound, settings)
            except BadInput as reason:
                refused[name], last = str(reason), reason
                continue
            if isinstance(tables[name], LawTable):  # the scheduled law's margins are judged where it is designed
                try:
                    demand_settling(bound, tables[name], row.float_law(tables[name]), row.plants)
                except BadInput as reason:
                    unsettled[name] = str(reason)
    if not tables:
        raise last
    return tables, refused, unsettled


def compare_controllers(
    bound: BoundPlant, tables: Mapping[str, Any], wanted: Wanted, folder: Path, each: Each
) -> list[Compared]:
    """Everything of each controller's table; `each` flies the spread plants and effects, as `map` does."""
    built = [build_controller(bound, name, table, wanted, folder) for name, table in tables.items()]
    laws = {entry.row.name: entry.law for entry in built}
    judged = judge(bound, laws, read_settings(bound).sample_period_s, wanted.trial, each)
    return [Compared(**vars(entry), **vars(judged[entry.row.name])) for entry in built]


def build_controller(bound: BoundPlant, name: str, table: Any, wanted: Wanted, folder: Path) -> Built:
    """One controller generated, verified, and flown through the figures; leaves its table, C and image in folder/NAME."""
    row = CONTROLLERS[name]
    texts = row.generate(table)
    place = folder / name
    write_atomic(place / "controller.json", row.text(table))
    for file, text in {**texts, **protocol_source(protocol_of(table.loops))}.items():
        write_atomic(place / "generated" / file, text)
    with stage(f"{name}: building the firmware"):
        image = build_firmware(texts, place, loops=table.loops)
    twin, host = row.twin(table), HostLaw(texts, loops=table.loops)
    target = TargetLaw(EmulatedBoard(image.elf), state_words=twin.state_words, loops=table.loops)
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
    with stage(f"{name}: flying the manoeuvres"):
        flights = fly_figures(bound, flown_law(bound, texts), table.sample_period_s)
    figures = {figure: flown.merits() for figure, flown in flights.items()}
    limits_V = tuple((axis.u_min_V, axis.u_max_V) for axis in table.axes)
    law = Law(texts, {share: _filtered(bound, row, table, share) for share in FILTERS})
    return Built(row, table.loops, limits_V, law, table.digest, equality, mismatches, cost, flights, figures)


def tuned_text(bound: BoundPlant, name: str, seed: int) -> str:
    """The open numbers of a controller as the plant file's section; raises BadInput for one without."""
    row = CONTROLLERS[name]
    if not isinstance(row, EquationController):
        raise BadInput("--tune", f"controller {name!r}", "no open numbers", "pid or fuzzy", "leave --tune out")
    with stage(f"tuning {row.title} by flights"):
        return tuned_section(name, tune(row, row.points(bound, read_settings(bound)), seed))


def _filtered(bound: BoundPlant, row: Controller, table: Any, share: float) -> Mapping[str, str]:
    """The controller's texts behind another reference filter, in shares of the plant file's time constants."""
    settings = read_settings(bound)
    for axis in (loop.axis for loop in settings.loops):
        time_constant_s = share * settings.axis(axis).prefilter_time_constant_s
        table = changed_axis(table, axis, prefilter_time_constant_s=time_constant_s)
    return row.generate(table)


def eq26_errors(bound: BoundPlant, names: Iterable[str]) -> Mapping[tuple[str, str], FormError]:
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
