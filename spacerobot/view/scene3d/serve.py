"""A page served to this machine alone: loopback, a port that nobody can guess beforehand, no other path."""

from __future__ import annotations

import secrets
import threading
from collections.abc import Callable, Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from spacerobot.support.errors import InputError, SpacerobotError

HOST = "127.0.0.1"

FRAMES = "frame-ancestors 'self' http://localhost:* http://127.0.0.1:* https://localhost:* vscode-webview:"
"""Whose pages may hold the page in a frame: notebooks of this machine."""


class PageServer:
    """Serves one page, made anew for every visit, until it is closed.

    Only requests that name this very address are answered, so that no other site's name can be pointed at it, and
    only under a path with a secret in it, so that other users of the machine do not find it.

    Args:
        make: gives the page's HTML.
        answers: what the page may ask for below its own address: name -> JSON from a query, None for nothing new.
        framed: whether notebooks of this machine may hold the page in a frame.

    Attributes:
        url: where the page is.
    """

    def __init__(
        self,
        make: Callable[[], str],
        *,
        answers: Mapping[str, Callable[[str], str | None]] | None = None,
        framed: bool = False,
    ) -> None:
        secret = secrets.token_urlsafe(12)
        asked = {f"/{secret}/{name}": answer for name, answer in (answers or {}).items()}

        class Handler(BaseHTTPRequestHandler):
            server_version, sys_version = "spacerobot", ""

            def do_GET(self) -> None:
                host = f"{HOST}:{server.server_port}"
                path, _, query = self.path.partition("?")
                answer = asked.get(path)
                if self.headers.get("Host") != host or (answer is None and self.path != f"/{secret}"):
                    self.send_error(404)
                    return
                try:
                    if answer is None:
                        status, kind, body = 200, "text/html", make().encode()
                    else:
                        found = answer(query)
                        status, kind, body = 204 if found is None else 200, "application/json", (found or "").encode()
                except InputError as error:
                    status, kind, body = 500 if answer is None else 400, "text/plain", f"{error}\n".encode()
                except SpacerobotError as error:  # what is shown was changed since, and is wrong now
                    status, kind, body = 500, "text/plain", f"{error}\n".encode()
                self.send_response(status)
                self.send_header("Content-Type", f"{kind}; charset=utf-8")
                self.send_header("Content-Length", str(len(body)))
                self.send_header("Cache-Control", "no-store")
                self.send_header("X-Content-Type-Options", "nosniff")
                if framed:
                    self.send_header("Content-Security-Policy", FRAMES)
                else:
                    self.send_header("X-Frame-Options", "SAMEORIGIN")
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, format: str, *args: object) -> None:
                """Say nothing: the terminal belongs to the command."""

        server = self._server = ThreadingHTTPServer((HOST, 0), Handler)
        self.url = f"http://{HOST}:{server.server_port}/{secret}"

    def serve(self) -> None:
        """Answer until `close` or an interrupt."""
        self._server.serve_forever(poll_interval=0.2)

    def start(self) -> None:
        """Answer from a thread of its own."""
        threading.Thread(target=self.serve, daemon=True).start()

    def close(self) -> None:
        """Stop and give the port back."""
        self._server.shutdown()
        self._server.server_close()
