"""`twinlaw diagnose` on flights of another firmware over the plant as stated: the firmware is told first, and the plant has no gap."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from records.diagnosis import Diagnosis, load_diagnosis
from records.errors import BadInput
from records.files import write_atomic
from records.log import save_log
from records.table import table_text
from sim.equilibrium import equilibrium
from sim.loop import Controller, Wired, fly
from sim.manoeuvres import Leg, manoeuvre
from sim.wiring import wiring
from tests.law_tables import ce150_table, changed_axis
from tests.plants import bound, stated_table
from tests.replay.firmware_flights import Wrapped, flown, plant, stale
from tests.soak import sampled
from twinlaw.command import main
from twinlaw.workflows.chain.flying import flight_of
from twinlaw.workflows.diagnose.material import read_material
from verification.host_law import host_law

TABLE = ce150_table()


def _wraps_at_8_V() -> Wrapped:
    def after(k: int, sent: list[tuple[float, float]]) -> tuple[float, float]:
        u_M_V, u_T_V = sent[k]
        return float(u_M_V - 16.0 * np.floor((u_M_V + 8.0) / 16.0)), u_T_V

    return Wrapped(host_law(TABLE), after=after)  # type: ignore[arg-type]


def _stale() -> Wrapped:
    return Wrapped(host_law(TABLE), stale((2, 3)))


def _other_gains() -> Controller:
    rows = tuple(tuple(1.05 * value for value in row) for row in TABLE.axes[0].q_V_rad)
    return host_law(changed_axis(TABLE, "elevation", q_V_rad=rows))


def _held_out(folder: Path, controller: Controller) -> Path:
    write_atomic(folder / "controller.json", table_text(TABLE))
    legs = (Leg(0.0, -20.0), Leg(1.0, 5.0)), (Leg(0.0, 0.0), Leg(2.0, 25.0), Leg(6.0, -10.0))
    plan = manoeuvre("held out", equilibrium(plant(), np.radians(-20.0)).x0, 10.0, 0.01, legs)
    save_log(folder / "hold.csv", fly(plant(), controller, plan, table_digest=TABLE.digest))
    return folder / "hold.csv"


def _diagnosed(folder: Path, controller: Controller, holdout: Controller | None = None) -> Diagnosis:
    write_atomic(folder / "controller.json", table_text(TABLE))
    save_log(folder / "run.csv", flown(controller, TABLE, 12.0))
    options = [] if holdout is None else ["--holdout", str(_held_out(folder, holdout))]
    out = folder / "out"
    assert main(["diagnose", "--plant", "plants/ce150.toml", *options, "--out", str(out), str(folder / "run.csv")]) == 0
    return load_diagnosis(out / "diagnosis.json")


OTHERS = [
    (_wraps_at_8_V, "output_wraps", "lets an integer overflow: u_M_V wraps round at +-8 V"),
    (_stale, "stale_sample", "used both angles measured one sample before"),
    (_other_gains, "not_found", "The log holds commands from 0 s on that the firmware of its table does not compute"),
]


@pytest.mark.soak
@pytest.mark.parametrize(("controller", "cause", "first"), sampled(OTHERS, keep=OTHERS[:1]))
def test_another_firmware_over_the_stated_plant_is_no_gap_and_is_told_first_and_the_tables_own_is_flown_again(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    controller: Callable[[], Controller],
    cause: str,
    first: str,
) -> None:
    found = _diagnosed(tmp_path, controller(), host_law(TABLE))
    # A held-out log of the table's own law is flown again in the closed loop.
    assert found.shrinkage is not None
    assert found.shrinkage.closed_loop is not None
    assert (found.verdict, found.found) == ("no gap", ())
    assert found.firmware is not None
    assert (found.firmware.bit_exact, (found.firmware.cause or "").partition(":")[0]) == (False, cause)
    told = capsys.readouterr().out
    assert 0 <= told.index(first) < told.index("no gap")
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert 0 <= page.index(first) < page.index("The plant file explains these logs")


class _Late:
    """The law of one loop, given the angle of the sample before."""

    def __init__(self, law: Controller) -> None:
        self._law, self._angle_rad = law, 0.0

    def reset(self, *angles_rad: float) -> None:
        (self._angle_rad,) = angles_rad
        self._law.reset(*angles_rad)

    def step(self, reference_rad: float, angle_rad: float) -> tuple[float, ...]:
        given_rad, self._angle_rad = self._angle_rad, angle_rad
        return self._law.step(reference_rad, given_rad)


def test_another_firmware_over_an_arm_as_stated_is_no_gap_and_is_told_first(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arm, table = bound("aeroshield"), stated_table("aeroshield")
    whole = flight_of(arm, table)
    part = replace(whole, t_s=whole.t_s[:1500], reference_rad=whole.reference_rad[:1500])
    log = fly(arm, Wired(_Late(host_law(table)), wiring(arm, table.loops)), part, table_digest=table.digest)
    write_atomic(tmp_path / "controller.json", table_text(table))
    save_log(tmp_path / "run.csv", log)
    words = ["diagnose", "--plant", "plants/aeroshield.toml", "--out", str(tmp_path / "out")]
    assert main([*words, str(tmp_path / "run.csv")]) == 0
    found = load_diagnosis(tmp_path / "out" / "diagnosis.json")
    assert (found.verdict, found.found) == ("no gap", ())
    assert found.firmware is not None
    assert (found.firmware.bit_exact, (found.firmware.cause or "").partition(":")[0]) == (False, "stale_sample")
    told, first = capsys.readouterr().out, "used the arm measured one sample before"
    assert 0 <= told.index(first) < told.index("no gap")
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert 0 <= page.index(first) < page.index("The plant file explains these logs")


@pytest.mark.parametrize(("controller", "flown_by"), [(lambda: host_law(TABLE), TABLE.digest), (_stale, None)])
def test_another_firmware_than_the_tables_own_law_flies_no_closed_loop_again(
    tmp_path: Path, controller: Callable[[], Controller], flown_by: str | None
) -> None:
    # Truth: what would fly it again is the table that the diagnosis is given, of its own firmware alone.
    _, material = read_material(Path("plants/ce150.toml"), [], [_held_out(tmp_path, controller())])
    (table,) = material.tables
    assert (None if table is None else table.digest) == flown_by


@pytest.mark.parametrize("rows", [1, 2])
def test_commands_in_rows_before_their_angles_are_refused_where_the_controllers_own_code_shows_it(
    tmp_path: Path, rows: int
) -> None:
    # Truth: the table's own law flew; in the log each command stands in the row of an angle that it does not know yet.
    log = flown(host_law(TABLE), TABLE, 5.0)
    write_atomic(tmp_path / "controller.json", table_text(TABLE))
    save_log(tmp_path / "run.csv", replace(log, u=log.u[np.minimum(np.arange(len(log.u)) + rows, len(log.u) - 1)]))
    with pytest.raises(
        BadInput, match=f"would have sent its output {'one sample' if rows == 1 else 'two samples'} before"
    ):
        read_material(Path("plants/ce150.toml"), [tmp_path / "run.csv"], [])
