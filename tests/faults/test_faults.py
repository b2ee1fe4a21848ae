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

FAILURE_CODES = (2, 3)
EARLIER_CONTENT = b"before"
PAGE = 4096
YEAR = 365.25 * 86_400.0
NOWHERE = dict.fromkeys(
    ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "NUMBA_CACHE_DIR", "MPLCONFIGDIR"), "/proc/nowhere"
)


@pytest.fixture(scope="session")
def reference_run(sources, forks, tmp_path_factory):
    """Function that runs a command without a fault, each once; its outcome, results and folder."""
    answers = {}

    def run(name):
        if name not in answers:
            out = tmp_path_factory.mktemp(name)
            if name == "report":
                shutil.copytree(run("run")[2], out, dirs_exist_ok=True)
            outcome = forks.run(WORKS[name].arguments(sources, out), out)
            assert outcome.code in (0, 3), outcome.errors
            answers[name] = outcome, results(out), out
        return answers[name]

    return run


@pytest.fixture
def folders(tmp_path, reference_run):
    """Function that makes a folder for the results of a command, in which a report stands as before."""

    def make(name, number):
        out = tmp_path / f"{name}_{number}"
        if name == "report":
            shutil.copytree(reference_run("run")[2], out)
            (out / "run/report.pdf").write_bytes(EARLIER_CONTENT)
        else:
            out.mkdir()
        return out

    return make


def instants(name, writes):
    """Writes at which something happens: the first, the last and others in between, the same every time."""
    writes_chosen = random.Random(name).sample(range(2, writes), min(INSTANTS, writes) - 2)  # noqa: S311
    return [1, *sorted(writes_chosen), writes]


def check_nothing_is_half_written(out, files):
    """Every file is the one before or the new one; stores and chains grow, and resuming checks them."""
    for name, digest in results(out).items():
        if ".zarr/" not in name and not name.endswith(".h5"):
            assert files.get(name) == digest or (out / name).read_bytes() == EARLIER_CONTENT, name


def check_resumed(name, sources, forks, out, reference_run):
    reference, files, _ = reference_run(name)
    check_nothing_is_half_written(out, files)
    if WORKS[name].once and results(out) == files:
        return
    arguments = WORKS[name].arguments(sources, out)
    has_store = (out / "results.zarr").exists()
    outcome = forks.run([*arguments, *(WORKS[name].resume_options if has_store else ())], out)
    assert outcome.code == reference.code, outcome.errors
    assert results(out) == files


def is_stop_of_fault(outcome, code, instant):
    """Whether a signal ended a command; it must have, unless the command was done with fewer writes.

    Results that are ready together are written together, so that their number depends on the machine.
    """
    assert outcome.code == code or outcome.writes < instant
    return outcome.code == code


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_a_command_killed_at_a_write_resumes_to_the_same_bytes(
    name, sources, forks, folders, reference_run, counter
):
    for instant in instants(name, reference_run(name)[0].writes):
        out = folders(name, instant)
        interruption = forks.run(WORKS[name].arguments(sources, out), out, instant=instant)
        counter[name, "killed at a write"] += is_stop_of_fault(interruption, -9, instant)
        check_resumed(name, sources, forks, out, reference_run)


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_a_command_killed_at_any_time_resumes_to_the_same_bytes(
    name, sources, forks, folders, reference_run, counter
):
    seconds = reference_run(name)[0].seconds
    random_times = random.Random(name)  # noqa: S311
    for number in range(INSTANTS):
        out = folders(name, number)
        instant = random_times.uniform(0.0, seconds)
        interruption = forks.run(WORKS[name].arguments(sources, out), out, instant=instant, action="clock")
        counter[name, "killed by the clock"] += interruption.code == -9
        check_resumed(name, sources, forks, out, reference_run)


def steps_kept(folder):
    """Steps in the chains of a folder, those of all ensembles together."""
    steps = []
    for path in folder.rglob("*.h5"):
        with h5py.File(path) as file:
            file.visititems(lambda _, item: steps.append(int(item.attrs.get("iteration", 0))))
    return sum(steps)


@pytest.mark.slow
@pytest.mark.parametrize("name", SAMPLING)
def test_sampling_killed_halfway_is_continued(name, sources, forks, tmp_path, counter):
    arguments = SAMPLING[name].arguments
    complete = tmp_path / "whole"
    complete.mkdir()
    reference = forks.run(arguments(sources, complete), complete)
    for steps in range(5, 5 + 10 * INSTANTS, 10):
        out = tmp_path / str(steps)
        out.mkdir()
        interruption = forks.run(arguments(sources, out), out, instant=steps, action="sampling")
        assert interruption.code == -9
        assert 0 < steps_kept(out) < steps_kept(complete)
        counter[name, "killed while sampling"] += 1
        continuation = forks.run(arguments(sources, out), out)
        assert continuation.code == reference.code == 0, continuation.errors
        assert results(out) == results(complete)


@pytest.mark.slow
@pytest.mark.parametrize("action", ["full", "terminate", "vanish"])
@pytest.mark.parametrize("name", WORKS)
def test_a_full_or_missing_disk_gives_one_error(
    name, action, sources, forks, folders, reference_run, counter
):
    writes = reference_run(name)[0].writes
    for instant in instants(name, writes):
        out = folders(name, instant)
        outcome = forks.run(WORKS[name].arguments(sources, out), out, instant=instant, action=action)
        assert "Traceback" not in outcome.errors, outcome.errors
        counter[name, action] += action != "terminate" or is_stop_of_fault(outcome, -15, instant)
        if action == "full":
            assert outcome.code in FAILURE_CODES or results(out) == reference_run(name)[1], outcome.errors
        if action == "vanish":  # what it wrote after that has lost the beginning
            check_nothing_is_half_written(out, reference_run(name)[1])
            shutil.rmtree(out, ignore_errors=True)
            out = folders(name, instant)
        check_resumed(name, sources, forks, out, reference_run)


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_a_quota_gives_one_error(name, sources, forks, folders, reference_run, counter):
    sizes = [path.stat().st_size for path in reference_run(name)[2].rglob("*") if path.is_file()]
    for number in range(INSTANTS):
        out = folders(name, number)
        quota = max(4096, max(sizes) * (number + 1) // (INSTANTS + 1))
        outcome = forks.run(WORKS[name].arguments(sources, out), out, instant=quota, action="quota")
        counter[name, "quota"] += outcome.code != reference_run(name)[0].code
        assert "Traceback" not in outcome.errors, outcome.errors
        assert outcome.code in FAILURE_CODES or results(out) == reference_run(name)[1], outcome.errors
        check_resumed(name, sources, forks, out, reference_run)


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_a_small_disk_gives_one_error(name, sources, forks, tmp_path, folders, reference_run, counter):
    """A disk in memory, where the system lets us mount one, on which a real write fails in the middle."""
    files = [path for path in reference_run(name)[2].rglob("*") if path.is_file()]
    size_of_results = sum(-(-path.stat().st_size // PAGE) * PAGE for path in files)
    for number in range(2):
        out = folders(name, number)
        size_of_earlier = size_of_results if name == "report" else 0  # which stands there before
        size = size_of_earlier + max(4096, size_of_results * (2 * number + 1) // 4)
        mount_command = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(out)]
        earlier_folder = tmp_path / "before"
        shutil.copytree(out, earlier_folder, dirs_exist_ok=True)
        if subprocess.run(mount_command, capture_output=True, check=False).returncode:  # noqa: S603
            pytest.skip("this process may not mount a disk")
        try:
            if name == "report":
                shutil.copytree(earlier_folder, out, dirs_exist_ok=True)
            outcome = forks.run(WORKS[name].arguments(sources, out), out)
            counter[name, "small disk"] += outcome.code != reference_run(name)[0].code
            assert "Traceback" not in outcome.errors, outcome.errors
            assert outcome.code in FAILURE_CODES or results(out) == reference_run(name)[1], outcome.errors
            larger = ["mount", "-o", "remount,size=1g", str(out)]
            subprocess.run(larger, check=True)  # noqa: S603
            check_resumed(name, sources, forks, out, reference_run)
        finally:
            subprocess.run(["umount", str(out)], check=True)  # noqa: S603, S607


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_a_read_only_folder_is_refused(
    name, sources, forks, folders, reference_run, counter, tmp_path_factory
):
    out = folders(name, 0)
    for folder in (sources, *out.parents):
        if folder.is_relative_to(tmp_path_factory.getbasetemp().parent):
            folder.chmod(0o755)  # pytest's own are its user's alone
    places = [out, *(path for path in out.rglob("*") if path.is_dir())]
    for place in places:
        place.chmod(0o555)
    try:
        outcome = forks.run(WORKS[name].arguments(sources, out), out, action="readonly")
        counter[name, "read-only folder"] += 1
        assert outcome.code in FAILURE_CODES, outcome.errors
        assert "Traceback" not in outcome.errors, outcome.errors
    finally:
        for place in places:
            place.chmod(0o755)
    check_resumed(name, sources, forks, out, reference_run)


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_of_two_processes_in_one_place_the_second_is_refused_or_finds_all_done(
    name, sources, folders, reference_run, counter
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
    counter[name, "two at once"] += 1
    assert "Traceback" not in "".join(errors), errors
    codes = sorted(process.returncode for process in running)
    reference_code = reference_run(name)[0].code
    assert codes in ([reference_code, reference_code], sorted([reference_code, 2])), errors
    assert results(out) == reference_run(name)[1]


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
def test_no_home_and_no_caches_are_needed(name, environment, sources, folders, reference_run, counter):
    out = folders(name, 0)
    outcome = command(WORKS[name].arguments(sources, out), environment)
    counter[name, "no home or caches"] += 1
    assert (outcome.code, outcome.errors) == (reference_run(name)[0].code, "")
    assert results(out) == reference_run(name)[1]


@pytest.mark.slow
@pytest.mark.parametrize("name", SAMPLING)
def test_posteriors_need_no_home_and_no_caches_either(name, sources, tmp_path, counter):
    outcome = command(SAMPLING[name].arguments(sources, tmp_path), NOWHERE)
    counter[name, "no home or caches"] += 1
    assert (outcome.code, outcome.errors) == (0, "")
    assert results(tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("years", [-20, 10], ids=["files from long ago", "files from the future"])
@pytest.mark.parametrize("name", WORKS)
def test_a_clock_set_meanwhile_changes_nothing(name, years, sources, forks, folders, reference_run, counter):
    out = folders(name, 0)
    half = max(1, reference_run(name)[0].writes // 2)
    interruption = forks.run(WORKS[name].arguments(sources, out), out, instant=half)
    assert is_stop_of_fault(interruption, -9, half)
    time_of_clock = time.time() + years * YEAR
    for path in out.rglob("*"):
        os.utime(path, (time_of_clock, time_of_clock))
    counter[name, "clock moved"] += 1
    check_resumed(name, sources, forks, out, reference_run)


@pytest.mark.slow
def test_two_first_runs_at_once_share_an_empty_cache_of_kernels(sources, tmp_path, reference_run, counter):
    places = [tmp_path / name for name in ("one", "other")]
    environment = {"NUMBA_CACHE_DIR": str(tmp_path / "kernels")}
    with ThreadPoolExecutor() as pool:
        outcomes = pool.map(
            lambda out: command(WORKS["simulate"].arguments(sources, out), environment), places
        )
        assert [(outcome.code, outcome.errors) for outcome in outcomes] == [(0, ""), (0, "")]
    counter["simulate", "one empty cache"] += 1
    assert list((tmp_path / "kernels").rglob("*.nbc"))
    for out in places:
        assert results(out) == reference_run("simulate")[1]
