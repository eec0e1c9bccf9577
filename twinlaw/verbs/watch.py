"""Watch a board or a log in the browser: angles, inputs, references, the link, and what the twin predicted one second before.

--port emulated (the default) flies DIR/firmware.elf on the emulated board, a device such as /dev/ttyACM0 a real one, and a log LOG.csv is
replayed. A board is in the loop of a simulated rig and its power stage stays off, unless --fly lets it fly on its own sensors.
The page stays on this computer. Ctrl-C disarms and ends.
"""

import argparse
import json
import signal
from collections.abc import Callable
from pathlib import Path

from jinja2 import Environment, FileSystemLoader

from records.errors import BadInput
from records.log import demand_log_place, save_log
from sim.bind import BoundPlant
from sim.loop import live_log
from twinlaw.cli import options
from twinlaw.cli.console import stage
from twinlaw.templates import TEMPLATES
from twinlaw.watching.board import BoardSource
from twinlaw.watching.events import Events
from twinlaw.watching.opening import Watched, open_watched
from twinlaw.watching.prediction import ready_lookahead
from twinlaw.watching.server import Server, Site, serve
from twinlaw.watching.session import Session
from twinlaw.watching.source import Source


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """--port, --dtr, --rts, --plant, --table, --arithmetic, --rig, --fly, --record, --http-port, --out, --json."""
    parser.add_argument(
        "--port",
        type=options.port_name,
        default="emulated",
        metavar="PORT|emulated|LOG.csv",
        help="what to watch; default: %(default)s",
    )
    options.signals(parser)
    options.plant(parser)
    options.table(parser)
    options.arithmetic(parser)
    parser.add_argument("--rig", type=Path, metavar="PLANT.toml", help="simulated rig; default: the plant itself")
    parser.add_argument("--fly", action="store_true", help="fly on the board's own sensors: THE RIG MOVES")
    parser.add_argument("--record", type=Path, metavar="LOG.csv", help="leave the last flight there as a run log")
    parser.add_argument("--http-port", type=_tcp_port, default=0, metavar="N", help="of the page; default: a free one")
    options.out(parser)
    options.as_json(parser)


def run(chosen: argparse.Namespace) -> int:
    """Open, serve, move it until Ctrl-C, disarm, leave the log."""
    if chosen.record is not None:
        demand_log_place(chosen.record)
    fields = ("port", "plant", "table", "out", "rig", "arithmetic", "fly")
    lines = options.modem_lines(chosen)
    bound, source, locked = open_watched(Watched(**{name: getattr(chosen, name) for name in fields}, lines=lines))
    try:
        if chosen.record is not None and not isinstance(source, BoardSource):
            raise BadInput("--record", str(chosen.record), "a replay", "a board", "the log is recorded already")
        with stage("compiling the twin's filter"):
            lookahead = ready_lookahead(bound, locked)
        session = Session(source, lookahead, Events())
        server = Server(Site(session, source.facts(), page_bytes()), chosen.http_port)
        end = serve(server)
        try:
            _run_until_told(session, lambda: _tell(server.url, chosen))
        finally:
            end()
    finally:
        source.close()
    return _leave(chosen, bound, source)


def page_bytes() -> bytes:
    """The page, whole."""
    environment = Environment(loader=FileSystemLoader(TEMPLATES), trim_blocks=True, keep_trailing_newline=False)
    return environment.get_template("watch.html.j2").render().encode()


def _run_until_told(session: Session, announce: Callable[[], None]) -> None:
    """Until Ctrl-C or a request to end, from when the address is told: between two samples, never in the middle of a frame."""
    former = {number: signal.signal(number, lambda *_: session.stop()) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        announce()
        session.run()
    finally:
        for number, handler in former.items():
            signal.signal(number, handler)


def _tell(url: str, chosen: argparse.Namespace) -> None:
    print(json.dumps({"url": url}) if chosen.json else f"open {url}\nCtrl-C disarms and ends", flush=True)


def _leave(chosen: argparse.Namespace, bound: BoundPlant, source: Source) -> int:
    """What is left when all is disarmed: the last flight, where it was asked for."""
    recorded, rows = None, 0
    if chosen.record is not None and isinstance(source, BoardSource) and len(source.rows) > 1:
        save_log(chosen.record, live_log(bound, source.rows, source.digest))
        recorded, rows = str(chosen.record), len(source.rows)
    if chosen.json:
        print(json.dumps({"recorded": recorded, "rows": rows}))
        return 0
    told = "nothing is armed"
    if recorded is not None:
        told += f"; {recorded} holds the last flight, {rows} rows"
    elif chosen.record is not None:
        told += f"; {chosen.record} was not written, as nothing flew"
    print(told)
    return 0


def _tcp_port(text: str) -> int:
    value = int(text) if text.isdecimal() else -1
    if not 0 <= value <= 65535:
        raise argparse.ArgumentTypeError(f"got {text[:30]!r}, expected a TCP port, 0 to 65535")
    return value
