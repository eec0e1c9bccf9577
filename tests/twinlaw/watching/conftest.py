"""A controller with its image on disk, and what is watched around them, for the tests of the live page."""

import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from codegen.law import generate_law
from records.log import save_log
from records.table import table_text
from rig.programming.image import build_firmware
from sim.loop import fly_law
from sim.manoeuvres import hop
from tests.plants import bound, stated_table
from twinlaw.verbs.watch import page_bytes
from twinlaw.watching.events import Events
from twinlaw.watching.opening import Watched, open_watched
from twinlaw.watching.prediction import ready_lookahead
from twinlaw.watching.server import Server, Site, serve
from twinlaw.watching.session import Session

PLANT = Path("plants/ce150.toml")
PATIENT_S = 30.0  # a page that is slow because the computer is busy with other tests is not lost


@pytest.fixture(scope="session")
def carried(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with controller.json, firmware.elf, and hop.csv, a short flight of that law."""
    folder = tmp_path_factory.mktemp("carried")
    rig, table = bound(PLANT.stem), stated_table(PLANT.stem)
    (folder / "controller.json").write_text(table_text(table), encoding="utf-8")
    build_firmware(generate_law(table), folder)
    save_log(folder / "hop.csv", fly_law(rig, table, hop(rig)))
    return folder


@dataclass(frozen=True)
class Watch:
    """A running watch: its session and its server."""

    session: Session
    server: Server


Open = Callable[..., Watch]


@pytest.fixture
def watch(carried: Path) -> Iterator[Open]:
    """watch(port, clock=..., **fields): serve what `twinlaw watch` would, in a thread of this process."""
    asked = Watched("emulated", PLANT, carried / "controller.json", carried, None, "float32", False)
    with ExitStack() as stack:

        def opened(port: str = "emulated", clock: Callable[[], float] | None = None, **fields: object) -> Watch:
            return stack.enter_context(running(replace(asked, port=port, **fields), clock))  # type: ignore[arg-type]

        yield opened


@contextmanager
def running(asked: Watched, clock: Callable[[], float] | None) -> Iterator[Watch]:
    rig, source, locked = open_watched(asked)
    clocked = {} if clock is None else {"clock": clock}
    session = Session(source, ready_lookahead(rig, locked), Events(), lost_s=PATIENT_S, **clocked)
    server = Server(Site(session, source.facts(), page_bytes()), 0)
    end = serve(server)
    mover = threading.Thread(target=session.run)
    mover.start()
    try:
        yield Watch(session, server)
    finally:
        session.stop()
        mover.join()
        end()
        source.close()
