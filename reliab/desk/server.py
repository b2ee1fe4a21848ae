"""The server of the desk: pages on the loopback address, for whoever knows the token."""

import secrets
import socket
import webbrowser
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final
from urllib.parse import urlsplit

import panel as pn
from panel.io.server import get_server
from tornado.httputil import HTTPHeaders, HTTPMessageDelegate, HTTPServerRequest
from tornado.routing import Router
from tornado.web import Application, RedirectHandler

from reliab.core.errors import InputError
from reliab.desk.elements import WEB
from reliab.desk.folder import DeskFolder
from reliab.desk.jobs import Jobs, Memories, PageMemory
from reliab.desk.page import REFRESH, Desk, Page
from reliab.desk.pages import PAGES

_OWN_SITES: Final = ("", "none", "same-origin")


def new_token() -> str:
    """Make a token that nobody guesses."""
    return secrets.token_urlsafe(24)


def is_allowed(path: str, headers: HTTPHeaders, *, token: str, hosts: frozenset[str]) -> bool:
    """Return whether a request is one of the desk's own pages.

    `hosts`: names with port under which the desk is reached. A page of another site can make a browser ask
    this machine, under that site's name or with its origin; it does not know the token.
    """
    origin, first = headers.get("Origin"), path.split("/")[1:2]
    return (
        bool(first)
        and secrets.compare_digest(first[0].encode(), token.encode())
        and headers.get("Host", "").lower() in hosts
        and (origin is None or urlsplit(origin).netloc.lower() in hosts)
        and headers.get("Sec-Fetch-Site", "") in _OWN_SITES
    )


class Guard(Router):  # type: ignore[misc]  # Tornado is read without its types
    """Stands before the application; what is not allowed is not found."""

    def __init__(self, application: Application, *, token: str, hosts: frozenset[str]) -> None:
        self._application, self._token, self._hosts = application, token, hosts

    def find_handler(
        self,
        request: HTTPServerRequest,
        **kwargs: Any,  # noqa: ANN401 - Tornado's
    ) -> HTTPMessageDelegate | None:
        """Hand an allowed request to the application."""
        if not is_allowed(request.path, request.headers, token=self._token, hosts=self._hosts):
            return None
        return self._application.find_handler(request, **kwargs)


ADDRESS: Final = "127.0.0.1"
_MOST_MESSAGE: Final = 40_000_000  # bytes of one message, which holds 10 MB of a dropped file
_UNUSED: Final = 60_000  # ms after which a page that nobody looks at is dropped


def serve_desk(
    folder: str | Path = ".",
    *,
    port: int = 0,
    browser: bool = True,
    say: Callable[[str], None] = print,
    name_options: Callable[[str], str] = str,
) -> None:
    """Serve the desk until it is interrupted.

    `folder`: whose tests, rigs and campaigns are offered; all that the desk writes lies in it. `port`: any
    that is free by default. `say` takes the address, once the desk answers; `name_options` writes the
    arguments that a message names as whoever started the desk calls them. Raises InputError if the folder
    is not there or not writable, or the port is taken.
    """
    place = DeskFolder.open_folder(folder)
    jobs = Jobs(str(place.work))
    try:
        token, port = new_token(), port or _free_port()
        server = _server(Desk(folder=place, jobs=jobs, write_as_options=name_options), token, port)
        address = f"http://{ADDRESS}:{port}/{token}/"
        server.start()
        say(address)
        if browser:
            server.io_loop.call_later(0.1, webbrowser.open, address)
        server.io_loop.start()
    except KeyboardInterrupt:
        pass
    finally:
        jobs.close()
        place.close()


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind((ADDRESS, 0))
        return int(probe.getsockname()[1])


def _server(desk: Desk, token: str, port: int) -> Any:  # noqa: ANN401 - Panel carries no types
    pn.extension("filedropper", sizing_mode="stretch_width", notifications=False)
    host, memories = f"{ADDRESS}:{port}", Memories()
    pages = {page.name: lambda page=page: _open_page(page, desk, memories, host) for page in PAGES}
    try:
        server = get_server(
            pages,
            port=port,
            address=ADDRESS,
            prefix=f"/{token}",
            websocket_origin=[host],
            websocket_max_message_size=_MOST_MESSAGE,
            unused_session_lifetime_milliseconds=_UNUSED,
            title={page.name: f"{page.title} – reliab desk" for page in PAGES},
            extra_patterns=[("/?", RedirectHandler, {"url": f"/{token}/judge", "permanent": False})],
            use_index=False,  # a list of pages, with fonts and pictures of the web
            location=False,  # it forgets the prefix where it adds style sheets late
            start=False,
            show=False,
        )
    except OSError as error:
        raise InputError(
            "The desk's port must be free",
            value=f"{port}: {error.strerror}",
            remedy="Name another with `port`",
        ) from error
    server._http.request_callback = Guard(server._tornado, token=token, hosts=frozenset({host}))  # noqa: SLF001
    return server


def _open_page(page: type[Page], desk: Desk, memories: Memories, host: str) -> pn.Template:
    """Make a page for one tab, which its address names; a tab without a name gets one."""
    tab = pn.state.session_args.get("desk", [b""])[0].decode("utf-8", "replace")
    key, pages = memories.find_tab(tab)
    is_open = page(desk, pages.setdefault(page.name, PageMemory()))
    template = pn.Template((WEB / "page.html").read_text(encoding="utf-8"))
    template.add_panel("form", is_open.form)
    template.add_panel("result", is_open.result)
    variables = {
        "host": host,
        "style": (WEB / "page.css").read_text(encoding="utf-8"),
        "pages": [(entry.name, entry.title) for entry in PAGES],
        "current": page.name,
        "key": key,
        "heading": page.heading,
        "about": page.about,
        "folder": str(desk.folder.path),
    }
    for name, value in variables.items():
        template.add_variable(name, value)
    pn.state.add_periodic_callback(is_open.refresh, period=REFRESH)
    return template
