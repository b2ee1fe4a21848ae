"""Long work says how long it will take, on a terminal by a bar and on any other stream by lines."""

import io
import re
import sys
import time

import pytest

from reliab.app import cli
from reliab.app.cli import output as module
from reliab.app.cli.output import duration, progress_bar, progress_lines
from reliab.core.progress import show_task, shows_tasks, silent
from reliab.motions.catalogue import write_suite
from reliab.motions.loading import load_motions


@pytest.fixture
def impatient(monkeypatch):
    """Lines come after a twentieth of a second."""
    monkeypatch.setattr(module, "FIRST_LINE", 0.05)


@pytest.fixture
def line_of(impatient, capsys):
    """Wait for a line on the stream of errors, for a minute at most."""
    del impatient
    stream = io.StringIO()

    def wait(pattern):
        begin = time.monotonic()
        while time.monotonic() < begin + 60.0:
            stream.write(capsys.readouterr().err)
            output = re.search(f"^{pattern}$", stream.getvalue(), re.MULTILINE)
            if output:
                return output
            time.sleep(0.01)
        raise AssertionError(stream.getvalue())

    return wait


def work(pieces, seconds, what="Simulating"):
    with progress_bar(what) as progress:
        for count in range(1, pieces + 1):
            time.sleep(seconds)
            progress(count, pieces)


def test_long_work_states_the_remaining_time(line_of):
    with progress_bar("Simulating") as progress:
        progress(3, 8)
        progress(4, 8)
        line_of(r"Simulating: 4 of 8 after \d+ seconds?, about \d+ seconds? left")


def test_work_without_a_finished_piece_says_so_and_then_its_estimate(line_of):
    with progress_bar("Simulating") as progress:
        line_of(r"Simulating: still at work after \d+ seconds?")
        progress(1, 2)
        line_of(r"Simulating: 1 of 2 after \d+ seconds?, about \d+ seconds? left")


def test_short_work_writes_nothing(capsys):
    work(3, 0.001)
    assert capsys.readouterr().err == ""


def test_pieces_done_before_do_not_make_the_estimate_shorter(line_of):
    with progress_bar("Resuming") as progress:
        progress(90, 100)
        time.sleep(0.3)
        progress(91, 100)
        left = line_of(r"Resuming: 91 of 100 after \d+ seconds?, about (\d+) seconds? left")
    assert int(left[1]) >= 2


@pytest.mark.usefixtures("impatient")
def test_an_unread_stream_does_not_end_the_work(monkeypatch):
    class Closed:
        def write(self, _text):
            raise BrokenPipeError

        def isatty(self):
            return False

    monkeypatch.setattr(sys, "stderr", Closed())
    work(4, 0.05)


def test_deep_task_is_shown_as_its_caller_shows_tasks():
    calls = []

    def show(what):
        calls.append(what)
        return progress_lines(what)

    with show_task("Nobody listens") as progress:
        assert progress is silent
    with shows_tasks(show), show_task("Learning") as progress:
        progress(1, 1)
    assert calls == ["Learning"]
    with shows_tasks(show), progress_bar("tests"), show_task("inside another") as progress:
        assert progress is silent


@pytest.mark.slow
@pytest.mark.usefixtures("impatient")
def test_command_states_its_time_where_no_terminal_is(tmp_path, capsys):
    model = "format = 1\nstructure = {frequency_hz = 1.0, damping_ratio = 0.05}\n"
    (tmp_path / "model.toml").write_text(model)
    write_suite(load_motions("synthetic")[:2], tmp_path / "motions")
    arguments = ["simulate", "--motions", str(tmp_path / "motions"), "--out", str(tmp_path / "results.zarr")]
    assert cli.run([*arguments, "--model", str(tmp_path / "model.toml")]) == 0
    assert "Simulating: " in capsys.readouterr().err


@pytest.mark.parametrize(
    ("seconds", "words"), [(0.2, "1 second"), (89.0, "89 seconds"), (91.0, "2 minutes"), (5400.0, "2 hours")]
)
def test_durations_are_read_at_a_glance(seconds, words):
    assert duration(seconds) == words
