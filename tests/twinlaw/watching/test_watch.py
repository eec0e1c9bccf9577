"""The server of the live page: who is kept out, who may arm, and that nothing stays armed when a page or the host is lost."""

import http.client
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from diagnosis.validate.ahead import Lookahead
from records.log import load_log, save_log
from rig.emulator.pty_port import PtyBoard
from rig.link.client import BoardClient
from sim.columns import log_columns
from sim.plants import MODELS
from tests.docs.reading.json_page import is_as_documented
from tests.soak import sampled
from tests.twinlaw.watching.conftest import PATIENT_S, PLANT, Open, Watch
from twinlaw.command import main
from twinlaw.watching.events import Events
from twinlaw.watching.opening import Watched, open_watched
from twinlaw.watching.session import Session

PATIENCE_S = 60.0


def until(condition: Callable[[], object]) -> None:
    """Wait for what must come; the patience only ends a test that has failed."""
    end = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end, "never true"
        time.sleep(0.01)


class Page:
    """A page without a browser: its event stream, its wishes, and a sign of life with each status while it `lives`."""

    def __init__(self, port: int, token: str) -> None:
        self.lives = True
        self._port, self._token = port, token
        self._stream = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
        self._stream.request("GET", f"/events?token={token}")
        self._answer = self._stream.getresponse()
        assert self._answer.status == 200
        self.hello = self.next("hello")

    def next(self, name: str, condition: Callable[[dict[str, Any]], object] = lambda content: True) -> dict[str, Any]:
        """The next event of that name for which the condition holds."""
        told, end = "", time.monotonic() + PATIENCE_S
        while True:
            assert time.monotonic() < end, f"no {name} of the kind that was waited for"
            line = self._answer.readline().decode().rstrip("\n")
            assert line or told or self._answer.isclosed() is False
            if line.startswith("event: "):
                told = line.removeprefix("event: ")
            elif line.startswith("data: ") and told in (name, "status"):
                content = json.loads(line.removeprefix("data: "))
                if self.lives and told == "status":
                    post(self._port, self._token, {}, {"X-Twinlaw-Page": self.hello["page"]}, "/alive")
                if told == name and condition(content):
                    return dict(content)

    def wish(self, **content: Any) -> tuple[int, dict[str, Any]]:
        """Status and answer."""
        headers = {"X-Twinlaw-Page": self.hello["page"]}
        return post(self._port, self._token, content, headers)

    def close(self) -> None:
        """As a browser closes it."""
        self._answer.close()
        self._stream.close()


def post(
    port: int, token: str, content: Any, headers: dict[str, str] | None = None, path: str = "/wish"
) -> tuple[int, dict[str, Any]]:
    given = {"Content-Type": "application/json", "X-Twinlaw-Token": token, **(headers or {})}
    body = content if isinstance(content, bytes) else json.dumps(content).encode()
    return ask(port, "POST", path, {name: value for name, value in given.items() if value}, body)


def ask(
    port: int, method: str, path: str, headers: dict[str, str], body: bytes | None = None
) -> tuple[int, dict[str, Any]]:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
    connection.request(method, path, body, headers)
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    return answer.status, json.loads(content) if content.startswith(b"{") else {}


def page_of(watch: Watch) -> Page:
    return Page(watch.server.server_port, watch.server.site.token)


def test_it_listens_on_the_loopback_interface_alone(watch: Open) -> None:
    server = watch().server
    assert server.server_address[0] == "127.0.0.1"
    assert server.url.startswith(f"http://127.0.0.1:{server.server_port}/#")


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Host": "rebound.example"}, 421),
        ({"Host": "rebound.example:{port}"}, 421),
        ({"Host": "127.0.0.1"}, 421),
        ({"Origin": "http://rebound.example"}, 403),
        ({"Origin": "null"}, 403),
        ({"Origin": "http://127.0.0.1:1"}, 403),
        ({"Origin": "https://127.0.0.1:{port}"}, 403),
        ({"Sec-Fetch-Site": "cross-site"}, 403),
        ({"Sec-Fetch-Site": "same-site"}, 403),
        ({"X-Twinlaw-Token": "guessed"}, 403),
        ({"X-Twinlaw-Token": ""}, 403),
        ({"X-Twinlaw-Token": "\xe4"}, 403),
        ({"Content-Type": "text/plain"}, 415),
        ({"Content-Type": "application/x-www-form-urlencoded"}, 415),
        ({"Content-Length": "100000"}, 413),
        ({"Content-Length": "-1"}, 413),
    ],
)
def test_a_foreign_wish_is_refused_and_arms_nothing(watch: Open, headers: dict[str, str], status: int) -> None:
    running = watch()
    port, page = running.server.server_port, page_of(running)
    own = {"X-Twinlaw-Page": page.hello["page"]}
    given = {name: value.replace("{port}", str(port)) for name, value in headers.items()}
    answer = post(port, running.server.site.token, {"do": "arm"}, {**own, **given})
    assert answer[0] == status
    assert answer[1]["error"]
    assert not running.session.source.armed
    assert page.wish(do="arm") == (200, {})  # the same without it is obeyed


@pytest.mark.parametrize(
    ("body", "status"),
    [
        (b"[]", 400),
        (b"{", 400),
        (b"[" * 900, 400),
        (b"{}", 404),
        (b'{"do": 1}', 404),
        (b'{"do": "fly away"}', 409),
        (b'{"do": "reference", "deg": [10, 20]}', 409),
        (b'{"do": "manoeuvre"}', 409),
        (b'{"do": "pause"}', 409),
    ],
)
def test_what_is_no_wish_or_no_wish_for_now_is_refused(watch: Open, body: bytes, status: int) -> None:
    running = watch()
    page = page_of(running)
    headers = {"X-Twinlaw-Page": page.hello["page"]}
    assert post(running.server.server_port, running.server.site.token, body, headers)[0] == status


@pytest.mark.parametrize(
    "deg", [None, "10", [10], [10, 20, 30], [10, "20"], [10, None], [1e9, 0], [0, True], [float("nan"), 0]]
)
def test_references_that_are_none_or_out_of_reach_are_refused(watch: Open, deg: Any) -> None:
    page = page_of(watch())
    assert page.wish(do="arm")[0] == 200
    before = page.next("status", lambda status: status["armed"])["reference_deg"]
    assert page.wish(do="reference", deg=deg)[0] == 409
    assert page.next("status")["reference_deg"] == before


def test_the_events_need_the_token_and_the_page_tells_nothing(watch: Open) -> None:
    server = watch().server
    port = server.server_port
    assert ask(port, "GET", "/events", {})[0] == 403
    assert ask(port, "GET", "/events?token=guessed", {})[0] == 403
    assert ask(port, "GET", "/etc/passwd", {})[0] == 404
    assert ask(port, "PUT", "/wish", {})[0] == 501
    assert server.site.token.encode() not in server.site.page
    connection = http.client.HTTPConnection("127.0.0.1", port)
    connection.request("GET", "/")
    answer = connection.getresponse()
    assert answer.status == 200
    assert answer.getheader("Access-Control-Allow-Origin") is None
    assert answer.getheader("X-Frame-Options") == "DENY"
    assert "default-src 'none'" in str(answer.getheader("Content-Security-Policy"))
    connection.close()


def test_a_page_sees_what_the_board_does_and_a_later_page_sees_it_too(watch: Open) -> None:
    running = watch()
    page = page_of(running)
    assert page.hello["kind"] == "board"
    assert [output["name"] for output in page.hello["outputs"]] == ["psi_rad", "phi_rad"]
    assert page.wish(do="arm") == (200, {})
    assert page.wish(do="reference", deg=[-20.0, 10.0]) == (200, {})
    rows = page.next("rows", lambda content: content["u"][0][-1] > 0.0 and content["r"][1][-1] > 0.17)
    # The references end on whole encoder steps.
    assert rows["r"][0][-1] / 1.5339807878856412e-3 == pytest.approx(
        round(rows["r"][0][-1] / 1.5339807878856412e-3), abs=1e-3
    )
    assert page.next("rows", lambda content: content["gap"][0] is not None)["ahead"]["t"]
    status = page.next("status", lambda status: status["counters"].get("frames_accepted", 0) > 100)
    assert (status["state"], status["armed"], status["pilot"]) == ("LOOP", True, page.hello["page"])
    assert status["counters"]["frames_lost"] == 0
    assert page_of(running).next("rows")["t"][0] <= rows["t"][-1]
    assert page.wish(do="stop") == (200, {})
    assert page.next("status", lambda status: not status["armed"])["state"] == "DISARMED"


def test_one_page_flies_and_any_page_may_stop(watch: Open) -> None:
    running = watch()
    one, other = page_of(running), page_of(running)
    assert one.wish(do="arm")[0] == 200
    for wish in ({"do": "arm"}, {"do": "manoeuvre"}, {"do": "reference", "deg": [0, 0]}):
        status, answer = other.wish(**wish)
        assert (status, "another page" in answer["error"]) == (409, True)
    assert one.wish(do="manoeuvre")[0] == 200
    assert other.wish(do="stop")[0] == 200
    assert not running.session.source.armed
    assert other.wish(do="arm")[0] == 200


def test_closing_the_page_that_armed_disarms(watch: Open) -> None:
    running = watch()
    page, onlooker = page_of(running), page_of(running)
    assert page.wish(do="arm")[0] == 200
    onlooker.next("status", lambda status: status["armed"])
    page.close()
    assert onlooker.next("status", lambda status: not status["armed"])["state"] == "DISARMED"
    assert page.wish(do="arm")[0] == 409  # what a closed page still asks for


def test_a_page_that_is_open_but_no_longer_answers_disarms(watch: Open) -> None:
    late_s = [0.0]
    running = watch(clock=lambda: time.monotonic() + late_s[0])
    page = page_of(running)
    assert page.wish(do="arm")[0] == 200
    page.next("status", lambda status: status["armed"])
    page.lives = False
    late_s[0] = PATIENT_S + 1.0
    disarmed = page.next("status", lambda status: not status["armed"])
    assert disarmed["state"] == "DISARMED"
    assert "silent for 30 s" in disarmed["trouble"]  # as a page that comes back would ask why
    page.lives = True
    assert page.wish(do="arm")[0] == 200
    assert page.next("status", lambda status: status["armed"])["trouble"] is None


def test_no_more_pages_than_eight(watch: Open) -> None:
    running = watch()
    pages = [page_of(running) for _ in range(8)]
    path = f"/events?token={running.server.site.token}"
    assert ask(running.server.server_port, "GET", path, {})[0] == 503
    pages[0].close()
    until(lambda: ask(running.server.server_port, "GET", "/", {})[0] == 200)


def test_a_log_is_replayed_paused_sped_up_and_begun_again(watch: Open, carried: Path) -> None:
    page = page_of(watch(str(carried / "hop.csv")))
    assert (page.hello["kind"], page.hello["duration_s"]) == ("log", 8.0)
    assert page.wish(do="arm")[0] == 409
    assert page.wish(do="speed", factor=3)[0] == 409
    assert page.wish(do="speed", factor=10.0)[0] == 200
    assert page.next("rows", lambda content: content["gap"][1] is not None)["ahead"]["p"][0]
    end = page.next("status", lambda status: not status["playing"])
    assert end["t_s"] == 8.0
    assert page.wish(do="seek", t_s=9.0)[0] == 409
    assert page.wish(do="seek", t_s=6.0)[0] == 200
    page.next("reset")
    rows = page.next("rows")
    assert rows["t"][0] == pytest.approx(1.0)  # five seconds before, so that the prediction is there at once
    assert page.wish(do="pause")[0] == 200
    stands = page.next("status", lambda status: not status["playing"])["t_s"]
    assert page.next("status")["t_s"] == stands
    assert page.wish(do="play")[0] == 200
    assert page.next("status", lambda status: status["playing"])["speed"] == 10.0


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--port", "/dev/ttyNONE"], "serial port"),
        (["--port", "missing.csv"], "missing.csv: run log"),
        (["--port", "missing.csv", "--plant", "nowhere.toml"], "missing.csv: run log"),
        (["--port", "{carried}/hop.csv", "--plant", "plants/aeroshield.toml"], "plant"),
        (["--port", "{carried}/hop.csv", "--fly"], "--fly"),
        (["--port", "{carried}/hop.csv", "--record", "x.csv"], "--record"),
        (["--record", "{carried}"], "a folder"),
        (["--record", "flown.toml"], "NAME.csv"),
        (["--record", "/dev/null/flown.csv"], "flown.csv"),
        (["--rig", "plants/aeroshield.toml"], "rig"),
        (["--plant", "plants/quanser_aero.toml"], "table"),
        (["--table", "missing.json"], "missing.json"),
        (["--out", "missing"], "firmware image"),
        (["--http-port", "99999"], "TCP port"),
        (["--arithmetic", "fixed"], "arithmetic"),
    ],
)
def test_what_cannot_be_watched_is_one_line(
    carried: Path, capsys: pytest.CaptureFixture[str], words: list[str], told: str
) -> None:
    given = [word.replace("{carried}", str(carried)) for word in words]
    defaults = ["--table", str(carried / "controller.json"), "--out", str(carried)]
    try:
        status = main(["watch", *defaults, *given])
    except SystemExit as error:
        status = int(error.code or 0)
    captured = capsys.readouterr()
    assert (status, captured.out) == (2, "")
    assert captured.err.count("\n") == 1
    assert told in captured.err


def test_a_tcp_port_that_is_taken_is_one_line(watch: Open, carried: Path, capsys: pytest.CaptureFixture[str]) -> None:
    taken = str(watch().server.server_port)
    defaults = ["--table", str(carried / "controller.json"), "--out", str(carried)]
    assert main(["watch", *defaults, "--http-port", taken]) == 2
    assert "a free port is taken" in capsys.readouterr().err


FLIGHT_THAT_COMPILES = """
from pathlib import Path
from records.log import load_log
from sim.columns import log_columns
from toolchain.cache import CACHE_DIR
from twinlaw.workflows.reading import load_bound
from twinlaw.watching.prediction import ready_lookahead
from twinlaw.watching.replay import live_rows

bound = load_bound(Path({plant!r}))
lookahead = ready_lookahead(bound, ())
before = set(CACHE_DIR.rglob("*.so"))
found = lookahead.take(live_rows(load_log(Path({log!r}), log_columns(bound.model)))[:320])
print(len(found), min(entry.t_s for entry in found), [path.name for path in set(CACHE_DIR.rglob("*.so")) - before])
"""


@pytest.mark.soak
def test_nothing_is_left_to_be_compiled_when_a_flight_begins(carried: Path, tmp_path: Path) -> None:
    # Truth: a flight whose prediction compiles after 3 s is ended by the board's wait for its host, or by the page's silence.
    program = FLIGHT_THAT_COMPILES.format(plant=str(PLANT), log=str(carried / "hop.csv"))
    told = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "TWINLAW_CACHE": str(tmp_path)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert told.stdout.split(maxsplit=2) == ["4", "3.0", "[]\n"]


def test_a_log_that_begins_late_says_from_where_the_page_counts(carried: Path, tmp_path: Path) -> None:
    # Truth: notes tell of 44 s and later, curves of the log's first row and later.
    log = load_log(carried / "hop.csv", log_columns(MODELS["ce150"]()))
    save_log(tmp_path / "late.csv", replace(log, t_s=log.t_s + 44.0))
    told = {}
    for name, folder in (("hop", carried), ("late", tmp_path)):
        asked = Watched(
            str(folder / f"{name}.csv"), PLANT, carried / "controller.json", carried, None, "float32", False
        )
        told[name] = open_watched(asked)[1].facts()["who"]
    assert "times of the curves count from 44 s of the log" in told["late"]
    assert "count from" not in told["hop"]


def test_a_log_whose_columns_are_likelier_others_is_shown_and_that_is_told(carried: Path, tmp_path: Path) -> None:
    """Truth: both angles were exchanged in one copy of a flight, and the commands logged a row late in another."""
    log = load_log(carried / "hop.csv", log_columns(MODELS["ce150"]()))
    late = replace(log, u=log.u[[0, *range(len(log.u) - 1)]])
    save_log(tmp_path / "exchanged.csv", replace(log, y=log.y[:, ::-1]))
    save_log(tmp_path / "late.csv", late)
    told = {}
    for name, folder in (("hop", carried), ("exchanged", tmp_path), ("late", tmp_path)):
        asked = Watched(
            str(folder / f"{name}.csv"), PLANT, carried / "controller.json", carried, None, "float32", False
        )
        told[name] = open_watched(asked)[1].facts()["who"]
    assert "psi_rad and phi_rad stand in each other's place" in told["exchanged"]
    assert "one row late" in told["late"]
    assert "nats" not in told["hop"]


def test_a_signal_at_the_end_of_a_wait_ends_it(carried: Path) -> None:
    # Truth: `stop` from the handler of a signal ends `run`, also where the handler takes longer than what is left of a wait.
    log = Watched(str(carried / "hop.csv"), PLANT, carried / "controller.json", carried, None, "float32", False)
    bound, source, locked = open_watched(log)
    source.obey({"do": "pause"})  # so that all its time passes in waits of 50 ms
    session, late = Session(source, Lookahead(bound, locked), Events()), []

    def slow(*_: object) -> None:
        time.sleep(0.2)
        session.stop()

    def rescue() -> None:
        late.append("woken by a wish")
        session.ask("page", {"do": "pause"})

    timer = threading.Timer(PATIENCE_S, rescue)
    former = signal.signal(signal.SIGALRM, slow)
    timer.start()
    signal.setitimer(signal.ITIMER_REAL, 0.325)
    try:
        session.run()
    finally:
        signal.signal(signal.SIGALRM, former)
        timer.cancel()
    assert late == []


@contextmanager
def started(*words: str) -> Iterator[tuple[subprocess.Popen[str], Page, Any]]:
    """`twinlaw watch` as a process of its own, with a page and what it printed first."""
    command = [sys.executable, "-m", "twinlaw.command", "watch", "--json", *words]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        first = json.loads(process.stdout.readline())
        address, token = first["url"].removeprefix("http://127.0.0.1:").split("/#")
        yield process, Page(int(address), token), first
    finally:
        process.kill()
        process.wait()


# That a board without its host makes itself safe is tested on the board: tests/rig/flight/test_live.py.
@pytest.mark.parametrize(
    ("way", "state"),
    sampled([(signal.SIGINT, "DISARMED"), (signal.SIGKILL, "LOST")], keep=[(signal.SIGINT, "DISARMED")]),
)
def test_ctrl_c_disarms_and_a_host_that_dies_leaves_the_board_to_make_itself_safe(
    carried: Path, tmp_path: Path, way: signal.Signals, state: str
) -> None:
    # The board runs in this process, behind a terminal device: the host that dies knows it as a serial port like any other.
    words = ["--table", str(carried / "controller.json"), "--record", str(tmp_path / "flown.csv")]
    with PtyBoard(carried / "firmware.elf") as board:
        with started("--port", board.path, *words) as (process, page, first):
            assert page.wish(do="arm")[0] == 200
            page.next("rows", lambda content: content["u"][0][-1] > 0.0)
            process.send_signal(way)
            status = process.wait(PATIENCE_S)
            assert process.stdout is not None
            last_words = process.stdout.read()
        assert status == (0 if way is signal.SIGINT else -way)
        with BoardClient.connect(board.path, timeout_s=1.0) as client:
            until(lambda: client.health().state in ("DISARMED", "LOST"))
            assert client.health().state == state
            assert not board.board.pwm().enabled
    if way is signal.SIGINT:
        log = load_log(tmp_path / "flown.csv", log_columns(MODELS["ce150"]()))
        assert len(log.t_s) > 1
        assert json.loads(last_words) == {"recorded": str(tmp_path / "flown.csv"), "rows": len(log.t_s)}
        assert is_as_documented("watch", {**first, **json.loads(last_words)})
        assert log.table_digest == json.loads((carried / "controller.json").read_text())["digest"]
    else:
        assert not os.listdir(tmp_path)
