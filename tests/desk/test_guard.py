"""Only the desk's own pages are answered."""

import pytest
from tornado.httputil import HTTPHeaders

from reliab.desk.server import is_allowed, new_token

HOST = "127.0.0.1:5000"
OWN_HEADERS = {"Host": HOST, "Origin": f"http://{HOST}", "Sec-Fetch-Site": "same-origin"}


def passes_guard(path="/secret/judge", **changes):
    headers = HTTPHeaders(
        {name: value for name, value in (OWN_HEADERS | changes).items() if value is not None}
    )
    return is_allowed(path, headers, token="secret", hosts=frozenset({HOST}))  # noqa: S106 - of a test


@pytest.mark.parametrize("path", ["/secret", "/secret/", "/secret/judge", "/secret/static/js/bokeh.min.js"])
def test_a_page_with_the_token_is_answered(path):
    assert passes_guard(path)
    assert passes_guard(path, **{"Origin": None, "Sec-Fetch-Site": "none"})  # an address that was typed


@pytest.mark.parametrize(
    "path",
    ["/", "", "/judge", "/Secret/judge", "/secre/judge", "/secret2/judge", "//secret/judge", "/é/judge"],
)
def test_a_page_without_the_token_is_not(path):
    assert not passes_guard(path)


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:5001"},
        {"Host": "evil.example"},  # a name that was made to point to this machine
        {"Host": "evil.example:5000", "Origin": "http://evil.example:5000"},
        {"Host": None},
        {"Sec-Fetch-Site": "cross-site", "Origin": None},
        {"Sec-Fetch-Site": "same-site"},
    ],
)
def test_requests_of_other_origins_are_refused_even_with_the_token(headers):
    assert not passes_guard(**headers)


def test_tokens_are_long_and_new():
    tokens = {new_token() for _ in range(100)}
    assert len(tokens) == 100
    assert min(map(len, tokens)) >= 32
