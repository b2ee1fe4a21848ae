"""A command that was killed and run again leaves what one leaves that was not."""

import os
import random
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import h5py
import pytest

from faults.commands import SAMPLING, WORKS, results
from faults.crashing import command

INSTANTS = int(os.environ.get("FAULTS", "5"))
"""How often each kind of fault happens to each command."""

FAILED = (2, 3)
BEFORE = b"before"
PAGE = 4096
YEAR = 365.25 * 86_400.0
NOWHERE = dict.fromkeys(
    ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "NUMBA_CACHE_DIR", "MPLCONFIGDIR"), "/proc/nowhere"
)


@pytest.fixture(scope="session")
def undisturbed(sources, forks, tmp_path_factory):
    """Function that runs a command without a fault, each once; its outcome, results and folder."""
    known = {}

    def run(name):
        if name not in known:
            out = tmp_path_factory.mktemp(name)
            if name == "report":
                shutil.copytree(run("run")[2], out, dirs_exist_ok=True)
            outcome = forks.run(WORKS[name].arguments(sources, out), out)
            assert outcome.code in (0, 3), outcome.errors
            known[name] = outcome, results(out), out
        return known[name]

    return run


@pytest.fixture
def folders(tmp_path, undisturbed):
    """Function that makes a folder for the results of a command, in which a report stands as before."""

    def make(name, number):
        out = tmp_path / f"{name}_{number}"
        if name == "report":
            shutil.copytree(undisturbed("run")[2], out)
            (out / "run/report.pdf").write_bytes(BEFORE)
        else:
            out.mkdir()
        return out

    return make


def instants(name, writes):
    """Writes at which something happens: the first, the last and others in between, the same every time."""
    chosen = random.Random(name).sample(range(2, writes), min(INSTANTS, writes) - 2)  # noqa: S311
    return [1, *sorted(chosen), writes]


def check_nothing_is_half_written(out, files):
    """Every file is the one before or the new one; stores and chains grow, and resuming checks them."""
    for name, digest in results(out).items():
        if ".zarr/" not in name and not name.endswith(".h5"):
            assert files.get(name) == digest or (out / name).read_bytes() == BEFORE, name


def check_resumed(name, sources, forks, out, undisturbed):
    expected, files, _ = undisturbed(name)
    check_nothing_is_half_written(out, files)
    if WORKS[name].once and results(out) == files:
        return
    arguments = WORKS[name].arguments(sources, out)
    begun = (out / "results.zarr").exists()
    resumed = forks.run([*arguments, *(WORKS[name].again if begun else ())], out)
    assert resumed.code == expected.code, resumed.errors
    assert results(out) == files


def stopped_there(outcome, code, at):
    """Whether a signal ended a command; it must have, unless the command was done with fewer writes.

    Results that are ready together are written together, so that their number depends on the machine.
    """
    assert outcome.code == code or outcome.writes < at
    return outcome.code == code


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_a_command_killed_at_a_write_resumes_to_the_same_bytes(
    name, sources, forks, folders, undisturbed, counted
):
    for at in instants(name, undisturbed(name)[0].writes):
        out = folders(name, at)
        killed = forks.run(WORKS[name].arguments(sources, out), out, at=at)
        counted[name, "killed at a write"] += stopped_there(killed, -9, at)
        check_resumed(name, sources, forks, out, undisturbed)


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_a_command_killed_at_any_time_resumes_to_the_same_bytes(
    name, sources, forks, folders, undisturbed, counted
):
    seconds = undisturbed(name)[0].seconds
    drawn = random.Random(name)  # noqa: S311
    for number in range(INSTANTS):
        out = folders(name, number)
        at = drawn.uniform(0.0, seconds)
        killed = forks.run(WORKS[name].arguments(sources, out), out, at=at, action="clock")
        counted[name, "killed by the clock"] += killed.code == -9
        check_resumed(name, sources, forks, out, undisturbed)


def steps_kept(folder):
    """Steps in the chains of a folder, those of all ensembles together."""
    steps = []
    for path in folder.rglob("*.h5"):
        with h5py.File(path) as file:
            file.visititems(lambda _, item: steps.append(int(item.attrs.get("iteration", 0))))
    return sum(steps)


@pytest.mark.slow
@pytest.mark.parametrize("name", SAMPLING)
def test_a_command_killed_while_it_samples_goes_on_with_what_it_has(name, sources, forks, tmp_path, counted):
    arguments = SAMPLING[name].arguments
    whole = tmp_path / "whole"
    whole.mkdir()
    undisturbed = forks.run(arguments(sources, whole), whole)
    for steps in range(5, 5 + 10 * INSTANTS, 10):
        out = tmp_path / str(steps)
        out.mkdir()
        killed = forks.run(arguments(sources, out), out, at=steps, action="sampling")
        assert killed.code == -9
        assert 0 < steps_kept(out) < steps_kept(whole)
        counted[name, "killed while sampling"] += 1
        resumed = forks.run(arguments(sources, out), out)
        assert resumed.code == undisturbed.code == 0, resumed.errors
        assert results(out) == results(whole)


@pytest.mark.slow
@pytest.mark.parametrize("action", ["full", "terminate", "vanish"])
@pytest.mark.parametrize("name", WORKS)
def test_a_disk_that_is_full_or_gone_gives_one_error(
    name, action, sources, forks, folders, undisturbed, counted
):
    writes = undisturbed(name)[0].writes
    for at in instants(name, writes):
        out = folders(name, at)
        stopped = forks.run(WORKS[name].arguments(sources, out), out, at=at, action=action)
        assert "Traceback" not in stopped.errors, stopped.errors
        counted[name, action] += action != "terminate" or stopped_there(stopped, -15, at)
        if action == "full":
            assert stopped.code in FAILED or results(out) == undisturbed(name)[1], stopped.errors
        if action == "vanish":  # what it wrote after that has lost the beginning
            check_nothing_is_half_written(out, undisturbed(name)[1])
            shutil.rmtree(out, ignore_errors=True)
            out = folders(name, at)
        check_resumed(name, sources, forks, out, undisturbed)


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_a_quota_gives_one_error(name, sources, forks, folders, undisturbed, counted):
    sizes = [path.stat().st_size for path in undisturbed(name)[2].rglob("*") if path.is_file()]
    for number in range(INSTANTS):
        out = folders(name, number)
        most = max(4096, max(sizes) * (number + 1) // (INSTANTS + 1))
        stopped = forks.run(WORKS[name].arguments(sources, out), out, at=most, action="quota")
        counted[name, "quota"] += stopped.code != undisturbed(name)[0].code
        assert "Traceback" not in stopped.errors, stopped.errors
        assert stopped.code in FAILED or results(out) == undisturbed(name)[1], stopped.errors
        check_resumed(name, sources, forks, out, undisturbed)


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_a_small_disk_gives_one_error(name, sources, forks, tmp_path, folders, undisturbed, counted):
    """A disk in memory, where the system lets us mount one, on which a real write fails in the middle."""
    files = [path for path in undisturbed(name)[2].rglob("*") if path.is_file()]
    needed = sum(-(-path.stat().st_size // PAGE) * PAGE for path in files)
    for number in range(2):
        out = folders(name, number)
        held = needed if name == "report" else 0  # which stands there before
        size = held + max(4096, needed * (2 * number + 1) // 4)
        mounted = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(out)]
        before = tmp_path / "before"
        shutil.copytree(out, before, dirs_exist_ok=True)
        if subprocess.run(mounted, capture_output=True, check=False).returncode:  # noqa: S603
            pytest.skip("this process may not mount a disk")
        try:
            if name == "report":
                shutil.copytree(before, out, dirs_exist_ok=True)
            stopped = forks.run(WORKS[name].arguments(sources, out), out)
            counted[name, "small disk"] += stopped.code != undisturbed(name)[0].code
            assert "Traceback" not in stopped.errors, stopped.errors
            assert stopped.code in FAILED or results(out) == undisturbed(name)[1], stopped.errors
            larger = ["mount", "-o", "remount,size=1g", str(out)]
            subprocess.run(larger, check=True)  # noqa: S603
            check_resumed(name, sources, forks, out, undisturbed)
        finally:
            subprocess.run(["umount", str(out)], check=True)  # noqa: S603, S607


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_a_folder_that_may_not_be_written_to_is_refused(
    name, sources, forks, folders, undisturbed, counted, tmp_path_factory
):
    out = folders(name, 0)
    for folder in (sources, *out.parents):
        if folder.is_relative_to(tmp_path_factory.getbasetemp().parent):
            folder.chmod(0o755)  # pytest's own are its user's alone
    places = [out, *(path for path in out.rglob("*") if path.is_dir())]
    for place in places:
        place.chmod(0o555)
    try:
        stopped = forks.run(WORKS[name].arguments(sources, out), out, action="readonly")
        counted[name, "read-only folder"] += 1
        assert stopped.code in FAILED, stopped.errors
        assert "Traceback" not in stopped.errors, stopped.errors
    finally:
        for place in places:
            place.chmod(0o755)
    check_resumed(name, sources, forks, out, undisturbed)


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_of_two_processes_in_one_place_the_second_is_refused_or_finds_all_done(
    name, sources, folders, undisturbed, counted
):
    out = folders(name, 0)
    program = "import sys; from reliab.app.cli import run; sys.exit(run(sys.argv[1:]))"
    arguments = [str(argument) for argument in WORKS[name].arguments(sources, out)]
    running = [
        subprocess.Popen(  # noqa: S603 - this very package
            [sys.executable, "-c", program, *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for _ in range(2)
    ]
    errors = [process.communicate()[1] for process in running]
    counted[name, "two at once"] += 1
    assert "Traceback" not in "".join(errors), errors
    codes = sorted(process.returncode for process in running)
    done = undisturbed(name)[0].code
    assert codes in ([done, done], sorted([done, 2])), errors
    assert results(out) == undisturbed(name)[1]


@pytest.mark.slow
@pytest.mark.parametrize(
    "environment",
    [
        {"HOME": "", "XDG_CACHE_HOME": ""},
        NOWHERE,
    ],
    ids=["no home", "no caches"],
)
@pytest.mark.parametrize("name", WORKS)
def test_no_home_and_no_caches_are_needed(name, environment, sources, folders, undisturbed, counted):
    out = folders(name, 0)
    outcome = command(WORKS[name].arguments(sources, out), environment)
    counted[name, "no home or caches"] += 1
    assert (outcome.code, outcome.errors) == (undisturbed(name)[0].code, "")
    assert results(out) == undisturbed(name)[1]


@pytest.mark.slow
@pytest.mark.parametrize("name", SAMPLING)
def test_posteriors_need_no_home_and_no_caches_either(name, sources, tmp_path, counted):
    outcome = command(SAMPLING[name].arguments(sources, tmp_path), NOWHERE)
    counted[name, "no home or caches"] += 1
    assert (outcome.code, outcome.errors) == (0, "")
    assert results(tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("years", [-20, 10], ids=["files from long ago", "files from the future"])
@pytest.mark.parametrize("name", WORKS)
def test_a_clock_that_was_moved_meanwhile_changes_nothing(
    name, years, sources, forks, folders, undisturbed, counted
):
    out = folders(name, 0)
    half = max(1, undisturbed(name)[0].writes // 2)
    killed = forks.run(WORKS[name].arguments(sources, out), out, at=half)
    assert stopped_there(killed, -9, half)
    moved = time.time() + years * YEAR
    for path in out.rglob("*"):
        os.utime(path, (moved, moved))
    counted[name, "clock moved"] += 1
    check_resumed(name, sources, forks, out, undisturbed)


@pytest.mark.slow
def test_two_first_runs_at_once_share_an_empty_cache_of_kernels(sources, tmp_path, undisturbed, counted):
    places = [tmp_path / name for name in ("one", "other")]
    environment = {"NUMBA_CACHE_DIR": str(tmp_path / "kernels")}
    with ThreadPoolExecutor() as together:
        outcomes = together.map(
            lambda out: command(WORKS["simulate"].arguments(sources, out), environment), places
        )
        assert [(outcome.code, outcome.errors) for outcome in outcomes] == [(0, ""), (0, "")]
    counted["simulate", "one empty cache"] += 1
    assert list((tmp_path / "kernels").rglob("*.nbc"))
    for out in places:
        assert results(out) == undisturbed("simulate")[1]
