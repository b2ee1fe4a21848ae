"""Terminals and pipes that lack characters get others in their place, and JSON stays exact."""

import json
import os
import subprocess
import sys

import pytest

COMMANDS = [
    ["--help"],
    ["criterion", "--help"],
    ["criterion", "--ellipses", "real_suite", "--f", "1", "--xi", "0.02"],
    ["run", "--list"],
]


def run_with(encoding, arguments):
    environment = {**os.environ, "PYTHONIOENCODING": encoding, "PYTHONUTF8": "0", "NO_COLOR": "1"}
    command = [sys.executable, "-c", "from reliab.cli import main; main()", *arguments]
    return subprocess.run(command, capture_output=True, env=environment, check=False)  # noqa: S603


@pytest.mark.parametrize(("encoding", "arguments"), [("cp1252", arguments) for arguments in COMMANDS])
def test_no_command_ends_in_an_encoding_error(encoding, arguments):
    done = run_with(encoding, arguments)
    assert done.returncode == 0, done.stderr.decode(encoding)
    assert b"UnicodeEncodeError" not in done.stderr


def test_symbols_are_written_out():
    done = run_with("ascii", COMMANDS[2])
    text = done.stdout.decode("ascii")
    assert "(A - 1)2/a + d2/b <= 1" in text
    assert "alpha" in text
    assert "?" not in text


def test_json_is_exact_whatever_the_encoding():
    arguments = [*COMMANDS[2], "--json", "-"]
    exact, escaped = (run_with(encoding, arguments).stdout for encoding in ("utf-8", "cp1252"))
    assert json.loads(escaped.decode("cp1252")) == json.loads(exact.decode("utf-8"))


def test_a_message_that_cannot_be_encoded_ends_with_its_sentence():
    done = run_with(
        "cp1252", ["criterion", "--ellipses", "real_suite", "--f", "1", "--xi", "0.02", "--law", "ξ"]
    )
    assert done.returncode == 2
    assert b"Error" in done.stderr
    assert b"Traceback" not in done.stderr
