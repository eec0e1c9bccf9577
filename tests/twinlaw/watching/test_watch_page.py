"""The live page in a real browser: what a person sees of a board and of a log, and what a foreign page cannot do."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.browser import Browser, Page
from tests.twinlaw.watching.conftest import Open, Watch


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with Browser() as running:
        yield running


def board_page(browser: Browser, running: Watch, width: int = 1100) -> Page:
    page = browser.open(running.server.url, width)
    page.wait_for("facts && status && !document.querySelector('#arm').disabled")
    return page


def dark_pixels(canvas: int) -> str:
    """How many pixels of a chart are neither paper, nor grid, nor grey text: lines."""
    return f"""(() => {{
        const canvas = document.querySelectorAll('canvas')[{canvas}];
        const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
        let count = 0;
        for (let k = 0; k < data.length; k += 4) {{
            const color = [data[k], data[k + 1], data[k + 2]];
            if (data[k + 3] > 200 && Math.max(...color) - Math.min(...color) > 100) count++;
        }}
        return count;
    }})()"""


def test_a_person_arms_flies_sees_the_twin_beside_the_rig_and_stops(browser: Browser, watch: Open) -> None:
    running = watch()
    page = board_page(browser, running)
    assert page.text("#title") == "emulated board"
    assert page.text("#state") == "disarmed, power stage off"
    page.click("#arm")
    page.wait_for("document.querySelector('#state').className === 'armed'")
    page.click("#manoeuvre")
    page.wait_for("status.manoeuvre && rows.at.length > 20")
    for chart in range(4):
        page.wait_for(f"{dark_pixels(chart)} > 50")
    captions = page.value("[...document.querySelectorAll('figcaption')].map((caption) => caption.innerText)")
    assert [caption.splitlines()[0] for caption in captions] == [
        "elevation psi [deg]",
        "azimuth phi [deg]",
        "measured minus predicted [deg]",
        "inputs [V]",
    ]
    assert "predicted 1 s before" in captions[0]
    page.wait_for("/^elevation psi[0-9.]+ deg/.test(document.querySelector('#gap').textContent)")
    assert page.value("[1.48e-11, 0.0213, 12.34, 123.4].map(number)") == ["0.0000", "0.0213", "12.3", "123"]
    assert "frames that the board took" in page.text("#health")
    page.value("document.dispatchEvent(new KeyboardEvent('keydown', {key: 'Escape'}))")
    page.wait_for("document.querySelector('#state').textContent === 'disarmed, power stage off'")
    assert not running.session.source.armed
    assert page.complaints() == []


def test_references_are_set_in_degrees_and_what_is_refused_is_told(browser: Browser, watch: Open) -> None:
    page = board_page(browser, watch())
    page.click("#arm")
    page.wait_for("!document.querySelector('#refer').disabled")
    page.value("document.querySelector('#ref0').value = -20")
    page.click("#refer")
    page.wait_for("Math.abs(status.reference_deg[0] + 20) < 0.05 && status.reference_deg[1] === 0")
    page.value("wish({do: 'reference', deg: [80, 0]})")
    page.wait_for("document.querySelector('#trouble').textContent.includes('-40 to 40 deg')")


def test_a_second_tab_may_stop_but_not_arm_and_closing_the_first_disarms(browser: Browser, watch: Open) -> None:
    running = watch()
    first, second = board_page(browser, running), board_page(browser, running)
    first.click("#arm")
    second.wait_for("document.querySelector('#note').textContent.startsWith('another page flies')")
    assert second.value("document.querySelector('#arm').disabled")
    second.value("wish({do: 'arm'})")
    second.wait_for("document.querySelector('#trouble').textContent.includes('another page')")
    first.close()
    second.wait_for("!status.armed && status.state === 'DISARMED'")
    assert not running.session.source.armed


def test_a_foreign_page_reads_nothing_and_arms_nothing(browser: Browser, watch: Open) -> None:
    running = watch()
    board_page(browser, running)
    port, token = running.server.server_port, running.server.site.token
    page = browser.open("data:text/html,<h1>foreign</h1>")
    address = f"http://127.0.0.1:{port}"
    for call in (
        f"fetch('{address}/')",
        f"fetch('{address}/events?token={token}')",
        f"fetch('{address}/wish', {{method: 'POST', headers: {{'X-Twinlaw-Token': '{token}', 'Content-Type': 'application/json'}}, "
        'body: \'{"do": "arm"}\'})',
    ):
        assert page.value(f"{call}.then((answer) => answer.status, () => 'blocked')") == "blocked"
    page.value(
        f"fetch('{address}/wish', {{method: 'POST', mode: 'no-cors', body: '{{\"do\": \"arm\"}}'}}).catch(() => 0)"
    )
    assert not running.session.source.armed


@pytest.mark.parametrize("width", [500, 1100])
def test_it_is_readable_in_a_narrow_and_in_a_wide_window(browser: Browser, watch: Open, width: int) -> None:
    page = board_page(browser, watch(), width)
    assert page.value("document.documentElement.scrollWidth") <= width
    stop = page.value("document.querySelector('#stop').getBoundingClientRect().toJSON()")
    assert 0 <= stop["top"] < 200
    chart = page.value("document.querySelector('canvas').getBoundingClientRect().toJSON()")
    assert chart["width"] > 0.6 * width
    assert chart["bottom"] < 900


def test_a_log_is_replayed_with_its_controls(browser: Browser, watch: Open, carried: Path) -> None:
    page = browser.open(watch(str(carried / "hop.csv")).server.url)
    page.wait_for("facts && status")
    assert page.text("#title") == "hop.csv"
    assert page.value("getComputedStyle(document.querySelector('#board')).display") == "none"
    page.value("(() => { const speed = document.querySelector('#speed'); speed.value = 10; speed.onchange(); })()")
    page.wait_for("rows.at.length > 20")
    page.wait_for("document.querySelector('#play').textContent === 'Again'")
    assert page.text("#instant") == "8.0 of 8.0 s"
    page.click("#play")
    page.wait_for("status.playing")
    page.click("#play")
    page.wait_for("document.querySelector('#state').textContent === 'paused'")


def test_a_line_ends_where_rows_are_missing(browser: Browser, watch: Open) -> None:
    # Truth: rows every 10 ms, three missing and later a second: the pen (M: set down, L: drawn) is lifted at the second alone.
    page = board_page(browser, watch())
    way = """(() => {
        let way = '';
        const pen = {beginPath() {}, setLineDash() {}, stroke() {}, moveTo() { way += 'M'; }, lineTo() { way += 'L'; }};
        const t = [0, 0.01, 0.02, 0.05, 0.06, 1.06, 1.07], v = t.map(() => 1);
        trace(pen, {t, v, style: MEASURED}, 0, (t) => t, (v) => v);
        return way;
    })()"""
    assert page.value(way) == "MLLLLML"


def test_every_axis_has_numbers_enough_to_read_its_scale(browser: Browser, watch: Open) -> None:
    page = board_page(browser, watch())
    # Centres and widths over four decades; a scale takes two numbers, a third shows that it is even.
    few = """(() => { const few = [];
        for (let k = 0; k < 400; k++) for (const centre of [0, 0.3, -7, 100]) {
            const half = 0.05 * 10 ** (k / 100), { found, digits } = ticks(centre - half, centre + half, 4);
            const told = new Set(found.map((value) => value.toFixed(digits)));
            if (told.size < 3 || told.size > 9 || told.size !== found.length) few.push([centre, half, [...told]]);
        }
        return few; })()"""
    assert page.value(few) == []


def test_an_address_without_its_token_says_what_to_do(browser: Browser, watch: Open) -> None:
    page = browser.open(watch().server.url.split("#")[0])
    page.wait_for("document.querySelector('#trouble').textContent.includes('not whole')")


@pytest.mark.soak
def test_a_page_whose_server_ends_says_so_and_offers_no_button(browser: Browser, watch: Open) -> None:
    running = watch()
    page = board_page(browser, running)
    running.server.site.closing.set()
    page.wait_for("document.querySelector('#trouble').textContent.includes('has ended')")
    assert page.value("[...document.querySelectorAll('button')].every((button) => button.disabled)")
