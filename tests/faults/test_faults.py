"""A command that was killed and run again leaves what one leaves that was not."""

import random
import subprocess
import sys

import pytest

from faults.commands import WORKS, material, results
from faults.crashing import Forks, command

CRASHES = 6
FAILED = (2, 3)


@pytest.fixture(scope="session")
def sources(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sources")
    material(folder)
    return folder


@pytest.fixture(scope="session")
def forks():
    running = Forks()
    yield running
    running.close()


@pytest.fixture(scope="session")
def undisturbed(sources, forks, tmp_path_factory):
    """Function that runs a command without a fault, each once; its outcome and results."""
    known = {}

    def run(name):
        if name not in known:
            out = tmp_path_factory.mktemp(name)
            outcome = forks.run(WORKS[name].arguments(sources, out), out)
            assert outcome.code in (0, 3), outcome.errors
            known[name] = outcome, results(out)
        return known[name]

    return run


def instants(name, writes):
    """Writes at which a command is killed: the first, the last and others in between, the same every time."""
    chosen = random.Random(name).sample(range(2, writes), min(CRASHES, writes) - 2)  # noqa: S311
    return [1, *sorted(chosen), writes]


def check_resumed(name, sources, forks, out, undisturbed):
    expected, files = undisturbed(name)
    arguments = WORKS[name].arguments(sources, out)
    begun = (out / "results.zarr").exists()
    resumed = forks.run([*arguments, *(WORKS[name].again if begun else ())], out)
    assert resumed.code == expected.code, resumed.errors
    assert results(out) == files


@pytest.mark.slow
def test_a_criterion_killed_while_written_is_the_one_before(sources, forks, tmp_path, undisturbed):
    (tmp_path / "criterion.json").write_text("before")
    killed = forks.run(WORKS["criterion"].arguments(sources, tmp_path), tmp_path, at=1)
    assert killed.code == -9
    assert (tmp_path / "criterion.json").read_text() == "before"
    check_resumed("criterion", sources, forks, tmp_path, undisturbed)


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_a_killed_command_resumes_to_the_same_bytes(name, sources, forks, tmp_path, undisturbed):
    writes = undisturbed(name)[0].writes
    for at in instants(name, writes):
        out = tmp_path / str(at)
        out.mkdir()
        killed = forks.run(WORKS[name].arguments(sources, out), out, at=at)
        assert killed.code == -9
        check_resumed(name, sources, forks, out, undisturbed)


@pytest.mark.slow
@pytest.mark.parametrize("action", ["full", "vanish", "terminate"])
@pytest.mark.parametrize("name", WORKS)
def test_a_disk_that_is_full_or_gone_gives_one_error(name, action, sources, forks, tmp_path, undisturbed):
    writes = undisturbed(name)[0].writes
    for at in instants(name, writes):
        out = tmp_path / str(at)
        out.mkdir()
        stopped = forks.run(WORKS[name].arguments(sources, out), out, at=at, action=action)
        assert "Traceback" not in stopped.errors, stopped.errors
        if action == "terminate":
            assert stopped.code == -15
        elif action == "full":
            assert stopped.code in FAILED or results(out) == undisturbed(name)[1], stopped.errors
        out.mkdir(exist_ok=True)
        check_resumed(name, sources, forks, out, undisturbed)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["simulate", "run"])
def test_of_two_processes_in_one_place_the_second_is_refused_or_finds_all_done(
    name, sources, tmp_path, undisturbed
):
    program = "import sys; from reliab.cli import run; sys.exit(run(sys.argv[1:]))"
    arguments = [str(argument) for argument in WORKS[name].arguments(sources, tmp_path)]
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
    assert "Traceback" not in "".join(errors)
    codes = sorted(process.returncode for process in running)
    assert codes in ([0, 0], [0, 2])
    assert results(tmp_path) == undisturbed(name)[1]


@pytest.mark.slow
@pytest.mark.parametrize(
    "environment",
    [
        {"HOME": "", "XDG_CACHE_HOME": ""},
        {"HOME": "/proc/nowhere", "NUMBA_CACHE_DIR": "/proc/nowhere", "MPLCONFIGDIR": "/proc/nowhere"},
        {"TZ": "Asia/Kathmandu", "LC_ALL": "tr_TR.UTF-8", "LANG": "tr_TR.UTF-8"},
        {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"},
        {"OMP_NUM_THREADS": "2", "NUMBA_NUM_THREADS": "2", "PYTHONHASHSEED": "7"},
    ],
    ids=["no home", "no caches", "another zone and language", "ASCII", "two threads"],
)
@pytest.mark.parametrize("name", ["simulate", "criterion", "run"])
def test_bytes_depend_on_no_home_zone_language_or_number_of_threads(
    name, environment, sources, tmp_path, undisturbed
):
    outcome = command(WORKS[name].arguments(sources, tmp_path), environment)
    assert outcome.code == 0, outcome.errors
    assert results(tmp_path) == undisturbed(name)[1]
