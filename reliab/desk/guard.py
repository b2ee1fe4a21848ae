"""Requests that the desk answers: from this machine, from its own pages, and with the token."""

import secrets
from typing import Any, Final
from urllib.parse import urlsplit

from tornado.httputil import HTTPHeaders, HTTPMessageDelegate, HTTPServerRequest
from tornado.routing import Router
from tornado.web import Application

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
