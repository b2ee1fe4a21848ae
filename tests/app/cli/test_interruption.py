"""Ctrl-C in a long command: one sentence, exit code 130, and nothing that was finished is lost."""

import ctypes
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from reliab.app.cli import interruption, run
from reliab.core.errors import INTERRUPTED
from reliab.core.interruption import notice_interruption

CHAINS = ("--method", "hierarchical", "--joint", "--chains", "chains.h5")
STRUCTURE = ("--f", "1", "--xi", "0.02")
COMMANDS = {
    "simulate": ("simulate", "--motions", "synthetic", *STRUCTURE, "--out", "results.zarr"),
    "run": ("run", "quick", "--out", "run"),
    "criterion": ("criterion", "--ellipses", "real_suite", *STRUCTURE, *CHAINS),
    "diagnose": ("diagnose", "rig_a", "--out", "diagnosis"),
    "ellipses": ("ellipses", "--motions", "synthetic", *STRUCTURE, "--out", "ellipses.nc"),
    "validate": ("validate", "--results", "real_suite", *STRUCTURE, "--trials", "200000"),
    "monitor": ("monitor", "sample_test", *STRUCTURE),
    "report": ("report", "run"),
    "explore": ("explore", "--out", "criterion.html"),
}
# seconds from the start to Ctrl-C where it is not LONG
RUNNING = {"explore": 1.5, "report": 0.8, "monitor": 4.0}
LONG = 7.0
LONGEST_ANSWER = 30.0  # s
SILENT_IMPORT = 0.1  # s


def heeding_ctrl_c():
    """Heed Ctrl-C, also where the tests run in the background of a shell, which has it ignored."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def interrupt(arguments, folder, after):
    """Run a command, press Ctrl-C, and return its exit code and what it said of it.

    On a machine that is done before, it is pressed in half the time. Coverage is not measured there: it
    would start in the time after which Ctrl-C is pressed.
    """
    environment = {name: value for name, value in os.environ.items() if not name.startswith("COVERAGE_")}
    with subprocess.Popen(  # noqa: S603
        [sys.executable, "-m", "reliab", *arguments],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**environment, "PYTHONPATH": str(Path(__file__).parents[3])},
        preexec_fn=heeding_ctrl_c,  # noqa: PLW1509 - it takes no lock
    ) as process:
        time.sleep(after)
        process.send_signal(signal.SIGINT)
        _, messages = process.communicate(timeout=LONGEST_ANSWER)
    if process.returncode in (0, -signal.SIGINT) and after > SILENT_IMPORT:  # done, or Python is ending
        shutil.rmtree(folder)
        folder.mkdir()
        return interrupt(arguments, folder, 0.5 * after)
    return process.returncode, messages.strip()


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="Windows sends Ctrl-C to a console, not to a process")
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.of_studies if name in {"run", "report"} else ())
        for name in COMMANDS
    ],
)
def test_a_long_command_ends_with_one_sentence(name, tmp_path):
    arguments = COMMANDS[name]
    if name == "report":
        assert run(["run", "quick", "--out", str(tmp_path / "before")]) == 0
        arguments = ("report", str(tmp_path / "before"))
    folder = tmp_path / "results"
    folder.mkdir()
    code, messages = interrupt(arguments, folder, RUNNING.get(name, LONG))
    assert code == 130
    assert messages in {interruption(arguments), "Interrupted."}  # the latter while modules are imported


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="Windows sends Ctrl-C to a console, not to a process")
def test_finished_work_is_kept_and_resumed(tmp_path, monkeypatch):
    folder = tmp_path / "results"
    folder.mkdir()
    simulate = ("simulate", "--motions", "synthetic", *STRUCTURE, "--out", "results.zarr")
    code, messages = interrupt(simulate, folder, LONG)
    monkeypatch.chdir(folder)
    assert code == 130
    assert "go on with --resume" in messages
    assert run([*simulate, "--resume"]) == 0


@pytest.mark.skipif(os.name == "nt", reason="Windows sends Ctrl-C to a console, not to a process")
def test_ctrl_c_while_modules_are_imported_is_no_traceback(tmp_path):
    code, messages = interrupt(["monitor", "-", *STRUCTURE], tmp_path, SILENT_IMPORT)
    # Python itself, before it reads the first line of ours, ends by the signal or with 1
    assert code in (130, -signal.SIGINT) or (code == 1 and "reliab" not in messages)
    assert "reliab/app/cli" not in messages


@pytest.fixture
def handles_interruption():
    """Ctrl-C is heeded, also where the tests run in the background of a shell."""
    original = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, original)


def press():
    signal.raise_signal(signal.SIGINT)


@pytest.mark.usefixtures("handles_interruption")
def test_a_library_error_after_ctrl_c_is_an_interruption():
    with pytest.raises(SystemExit) as end, notice_interruption():  # noqa: PT012 - what a compiler does
        try:
            press()
        except KeyboardInterrupt:
            raise RuntimeError("no compiled object yet") from None
    assert end.value.code == INTERRUPTED


@pytest.mark.usefixtures("handles_interruption")
def test_a_ctrl_c_lost_in_a_callback_is_repeated():
    callback = ctypes.CFUNCTYPE(None)(press)
    with pytest.raises(KeyboardInterrupt), notice_interruption():  # noqa: PT012 - what a compiler does
        callback()  # what is raised there is lost
        for _ in range(500):
            time.sleep(0.01)


@pytest.mark.usefixtures("handles_interruption")
def test_a_ctrl_c_lost_just_before_the_end_is_an_interruption():
    callback = ctypes.CFUNCTYPE(None)(press)
    with pytest.raises(KeyboardInterrupt), notice_interruption():
        callback()


@pytest.mark.usefixtures("handles_interruption")
def test_errors_without_ctrl_c_stay_unchanged():
    with pytest.raises(RuntimeError, match="as it was"), notice_interruption():
        raise RuntimeError("as it was")
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
