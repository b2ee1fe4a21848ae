"""Work in other processes: progress, news, outcome, refusal, cancelling and death."""

import os
import signal
import sys
import time
from importlib import import_module

import pytest
import typer

from reliab.app.cli import application, run
from reliab.app.cli.commands import as_options
from reliab.core.errors import InputError
from reliab.desk import jobs as desk_jobs
from reliab.desk.jobs import Jobs, Memories
from reliab.desk.work import look_at

PATIENCE = 120.0


def until(question):
    end = time.monotonic() + PATIENCE
    while not question():
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.fixture
def work(tmp_path, monkeypatch):
    """Functions that workers can import."""
    (tmp_path / "desk_work.py").write_text(
        "import os, time\n"
        "from reliab.desk.jobs import Tell\n"
        "from reliab.core.errors import InputError\n"
        "from reliab.core.progress import show_task\n"
        "def steps(tell: Tell):\n"
        "    with show_task('Counting') as progress:\n"
        "        for k in range(3):\n"
        "            progress(k + 1, 3)\n"
        "            tell(k)\n"
        "    print('what libraries print goes elsewhere')\n"
        "    return 'all'\n"
        "def refuse():\n    raise InputError('It must be even', value=3, remedy='Give 4')\n"
        "def fail():\n    raise RuntimeError('a bug')\n"
        "def die():\n    os._exit(9)\n"
        "def wait(file):\n    open(file, 'w').close(); time.sleep(600)\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    desk_work = import_module("desk_work")

    workers = Jobs(str(tmp_path))
    yield workers, desk_work
    workers.close()
    sys.modules.pop("desk_work")


@pytest.mark.slow
def test_work_reports_progress_and_ends_with_outcome_or_reason(work):
    jobs, functions = work
    first = jobs.start(functions.steps)
    until(lambda: first.is_over)
    assert (first.state, first.outcome, first.news, first.task) == ("finished", "all", [0, 1, 2], "Counting")
    refusal, failure, dead = map(jobs.start, (functions.refuse, functions.fail, functions.die))
    until(lambda: refusal.is_over and failure.is_over and dead.is_over)
    assert refusal.refusal == str(InputError("It must be even", value=3, remedy="Give 4"))
    assert "RuntimeError: a bug" in failure.refusal
    assert "says nothing about the test" in failure.refusal
    assert "ended without an answer" in dead.refusal
    second_run = jobs.start(functions.steps)
    until(lambda: second_run.is_over)
    assert second_run.outcome == "all"


@pytest.mark.slow
def test_cancelled_work_stops_its_process_at_once(work, tmp_path):
    jobs, functions = work
    began = tmp_path / "began"
    job = jobs.start(functions.wait, file=str(began))
    until(began.exists)
    process = job.worker.process
    jobs.cancel(job)
    assert job.state == "cancelled"
    until(lambda: process.exitcode is not None)
    next_job = jobs.start(functions.steps)
    until(lambda: next_job.is_over)
    assert (next_job.outcome, job.state) == ("all", "cancelled")


def test_work_beyond_the_workers_waits_and_may_be_cancelled_before_it_begins(work, tmp_path):
    jobs, functions = work
    busy = [jobs.start(functions.wait, file=str(tmp_path / str(k))) for k in range(desk_jobs.MOST_WORKERS)]
    until(lambda: all(job.state == "running" for job in busy))
    late = jobs.start(functions.steps)
    time.sleep(0.2)
    assert late.state == "waiting"
    jobs.cancel(late)
    for job in busy:
        jobs.cancel(job)
    assert late.state == "cancelled"


@pytest.mark.slow
def test_workers_end_with_the_desk(work, tmp_path):
    jobs, functions = work
    job = jobs.start(functions.wait, file=str(tmp_path / "began"))
    until((tmp_path / "began").exists)
    jobs.close()
    until(lambda: job.worker.process.exitcode is not None)
    until(lambda: job.is_over)


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="processes are stopped otherwise there")
def test_a_worker_ended_by_the_system_is_explained(work, tmp_path):
    jobs, functions = work
    job = jobs.start(functions.wait, file=str(tmp_path / "began"))
    until((tmp_path / "began").exists)
    os.kill(job.worker.process.pid, signal.SIGKILL)
    until(lambda: job.is_over)
    assert "ended without an answer" in job.refusal


def test_hostile_files_are_refused_with_the_sentence_of_the_command_line(tmp_path, capsys):
    path = tmp_path / "bad.csv"
    path.write_text("<svg onload=alert(1)>,1\n" * 90, encoding="utf-8")
    assert run(["assess", str(path), "--f", "1"]) == 2
    with pytest.raises(InputError) as refusal:
        look_at(path=str(path))
    sentence = str(refusal.value)
    output = as_options(sentence, typer.main.get_command(application("assess")))
    assert " ".join(capsys.readouterr().err.split()) == f"Error: {output}"
    assert path.name in sentence


def test_tabs_do_not_mix_and_forged_keys_open_nothing():
    memories = Memories()
    first, pages = memories.find_tab("")
    second, other_pages = memories.find_tab("")
    assert first != second
    assert pages is not other_pages
    assert memories.find_tab(first) == (first, pages)
    for token in ("a" * 20, "../../x", "<script>", first + "x"):
        key, new = memories.find_tab(token)
        assert key != token
        assert new == {}


def test_least_recently_used_tabs_are_forgotten():
    memories = Memories()
    keys = [memories.find_tab("")[0] for _ in range(60)]
    assert memories.find_tab(keys[-1])[0] == keys[-1]
    assert memories.find_tab(keys[0])[0] != keys[0]
