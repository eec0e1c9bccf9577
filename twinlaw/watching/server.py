"""The page's server: on the loopback interface only, for pages that it served itself, with a token of this run.

What keeps others out: connections come from this computer alone; a foreign Host header (a name that was rebound to 127.0.0.1) and a foreign
Origin are refused; all but the empty page needs the token, which stands behind # in the printed address and so is in no log and no Referer;
what changes anything is a POST of JSON with the token in a header that no form and no foreign script can send; no page may frame this one.
"""

import hmac
import json
import secrets
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlsplit

from records.errors import BadInput
from twinlaw.watching.headers import SAFETY, policy
from twinlaw.watching.session import Session

HOST = "127.0.0.1"
TOKEN_HEADER, PAGE_HEADER = "X-Twinlaw-Token", "X-Twinlaw-Page"
LONGEST_BODY = 1000
PAGES = 8
HEARTBEAT_S = 1.0
POLL_S = 0.05
SILENCE_S = 20.0  # a connection that says nothing for so long is closed


@dataclass
class Site:
    """What the handlers share: the session, the page's bytes, the token, and how many pages are open."""

    session: Session
    facts: Mapping[str, Any]
    page: bytes
    token: str = field(default_factory=lambda: secrets.token_urlsafe(24))
    open_pages: threading.BoundedSemaphore = field(default_factory=lambda: threading.BoundedSemaphore(PAGES))
    closing: threading.Event = field(default_factory=threading.Event)


class Server(ThreadingHTTPServer):
    """Listens on the loopback interface; `port` 0 takes a free one. Raises BadInput for a port that cannot be had."""

    daemon_threads = True

    def __init__(self, site: Site, port: int) -> None:
        self.site = site
        try:
            super().__init__((HOST, port), Handler)
        except OSError as error:
            got, remedy = error.strerror or str(error), "leave --http-port out, and a free port is taken"
            raise BadInput("TCP port", f"{HOST}:{port}", got, "a port that is free", remedy) from error

    @property
    def url(self) -> str:
        """The address to open, token included."""
        return f"http://{HOST}:{self.server_port}/#{self.site.token}"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A browser that leaves in the middle of an answer is no error of ours."""


class Handler(BaseHTTPRequestHandler):
    """One connection."""

    server: Server
    protocol_version = "HTTP/1.1"
    server_version = "twinlaw"
    sys_version = ""
    timeout = SILENCE_S

    def do_GET(self) -> None:
        """The page, or its events."""
        path = urlsplit(self.path)
        if not self._is_ours():
            return
        if path.path == "/":
            self._answer(HTTPStatus.OK, self.server.site.page, "text/html; charset=utf-8")
        elif path.path == "/events":
            if self._has_token(parse_qs(path.query).get("token", [""])[0]):
                self._events()
        else:
            self._refuse(HTTPStatus.NOT_FOUND, "there is only /")

    def do_POST(self) -> None:
        """A wish of a page, or its sign of life."""
        if not self._is_ours() or not self._has_token(self.headers.get(TOKEN_HEADER, "")):
            return
        wish, page, path = self._body(), self.headers.get(PAGE_HEADER, ""), urlsplit(self.path).path
        if wish is None:
            return
        if path == "/alive":
            self.server.site.session.heard(page)
            self._answer(HTTPStatus.OK, b"{}", "application/json")
        elif path == "/wish" and isinstance(wish.get("do"), str):
            self._ask(page, wish)
        else:
            self._refuse(HTTPStatus.NOT_FOUND, "there are only /wish and /alive")

    def _ask(self, page: str, wish: Mapping[str, Any]) -> None:
        try:
            self.server.site.session.ask(page, wish)
        except BadInput as error:
            self._refuse(HTTPStatus.CONFLICT, f"got {error.got}, expected {error.expected}; {error.remedy}")
        else:
            self._answer(HTTPStatus.OK, b"{}", "application/json")

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing: the terminal is for what concerns the board."""

    def _is_ours(self) -> bool:
        """Whether Host and Origin are this server's own; answers itself where they are not."""
        port = self.server.server_port
        hosts = (f"{HOST}:{port}", f"localhost:{port}")
        origin, site = self.headers.get("Origin"), self.headers.get("Sec-Fetch-Site")
        if self.headers.get("Host", "").lower() not in hosts:
            self._refuse(HTTPStatus.MISDIRECTED_REQUEST, "this server answers to its own address alone")
        elif origin is not None and origin not in [f"http://{host}" for host in hosts]:
            self._refuse(HTTPStatus.FORBIDDEN, "a page of another origin")
        elif site not in (None, "same-origin", "none") and urlsplit(self.path).path != "/":
            self._refuse(HTTPStatus.FORBIDDEN, "a page of another site")
        else:
            return True
        return False

    def _has_token(self, given: str) -> bool:
        if hmac.compare_digest(given.encode(), self.server.site.token.encode()):
            return True
        self._refuse(HTTPStatus.FORBIDDEN, "the address is not whole: open the one that `twinlaw watch` printed")
        return False

    def _body(self) -> dict[str, Any] | None:
        """The JSON object of a POST; None, and an answer, where there is none."""
        length = self.headers.get("Content-Length", "")
        if self.headers.get_content_type() != "application/json":
            self._refuse(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "a wish is JSON")
        elif not length.isdecimal() or int(length) > LONGEST_BODY:
            self._refuse(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"a wish has {LONGEST_BODY} bytes at most")
        else:
            try:
                content = json.loads(self.rfile.read(int(length)))
            except (ValueError, RecursionError):
                content = None
            if isinstance(content, dict):
                return content
            self._refuse(HTTPStatus.BAD_REQUEST, "a wish is a JSON object")
        return None

    def _events(self) -> None:
        """Server-sent events until the page leaves or the server ends."""
        site = self.server.site
        if not site.open_pages.acquire(blocking=False):
            self._refuse(HTTPStatus.SERVICE_UNAVAILABLE, f"{PAGES} pages are open; close one")
            return
        page = secrets.token_urlsafe(9)
        site.session.opened(page)
        try:
            self._head(HTTPStatus.OK, "text/event-stream", None)
            self._send("hello", json.dumps({**site.facts, "page": page}, allow_nan=False))
            self._follow(site)
        except OSError:
            pass  # the page has left
        finally:
            site.session.gone(page)
            site.open_pages.release()
            self.close_connection = True

    def _follow(self, site: Site) -> None:
        number = 0
        while not site.closing.is_set():
            news = site.session.events.after(number, HEARTBEAT_S)
            for event in news:
                self._send(event.name, event.text)
                number = max(number, event.number)
            if not news:
                self.wfile.write(b":\n\n")
        self._send("end", "{}")

    def _send(self, name: str, text: str) -> None:
        self.wfile.write(f"event: {name}\ndata: {text}\n\n".encode())

    def _refuse(self, status: HTTPStatus, why: str) -> None:
        self.close_connection = True  # a body that was not read must not be taken for the next request
        self._answer(status, json.dumps({"error": why}).encode(), "application/json")

    def _answer(self, status: HTTPStatus, content: bytes, kind: str) -> None:
        self._head(status, kind, len(content))
        if self.command != "HEAD":
            self.wfile.write(content)

    def _head(self, status: HTTPStatus, kind: str, length: int | None) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        if length is not None:
            self.send_header("Content-Length", str(length))
        if length is None or self.close_connection:
            self.send_header("Connection", "close")
        for name, value in SAFETY.items():
            self.send_header(name, value)
        if kind.startswith("text/html"):
            self.send_header("Content-Security-Policy", policy(self.server.site.page.decode()))
        self.end_headers()


def serve(server: Server) -> Callable[[], None]:
    """Serve in a thread of its own; the returned function ends it."""
    thread = threading.Thread(target=server.serve_forever, args=(POLL_S,), name="page", daemon=True)
    thread.start()

    def end() -> None:
        server.site.closing.set()
        server.shutdown()
        server.server_close()

    return end
