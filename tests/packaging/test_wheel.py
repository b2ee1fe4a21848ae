"""What is built from the sources: contents and size, and that an empty environment can use it."""

import json
import os
import subprocess
import sys
import tarfile
import tomllib
import venv
import zipfile
from functools import partial
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NOT_IN_WHEEL = {"real_suite/results.nc", "real_suite/make.py"}
MEGABYTE = 1e6
LARGEST_WHEEL, LARGEST_SOURCES = 8.0, 60.0  # MB


def list_shipped_files(kind):
    return {path.relative_to(ROOT / kind).as_posix() for path in (ROOT / kind).rglob("*") if path.is_file()}


def drop_caches(names):
    return {name for name in names if "__pycache__" not in name}


def test_every_dataset_is_named_for_the_wheel():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    table = project["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]
    sources = [ROOT / name for name in table if name.startswith("datasets/")]
    paths = {
        file.relative_to(ROOT / "datasets").as_posix()
        for path in sources
        for file in (path.rglob("*") if path.is_dir() else [path])
        if file.is_file()
    }
    assert drop_caches(list_shipped_files("datasets") - paths) == NOT_IN_WHEEL
    assert all(path.exists() for path in sources)


@pytest.fixture(scope="module")
def wheel_file(tmp_path_factory):
    """Wheel, source distribution, and the Python that can build them."""
    folder = tmp_path_factory.mktemp("dist")
    environment = tmp_path_factory.mktemp("build") / "venv"
    python = environment_with_wheel(environment)
    assert run_checked(python, "-m", "pip", "install", "--quiet", "build").returncode == 0
    building = run_checked(python, "-m", "build", "--outdir", folder, ROOT)
    assert building.returncode == 0, building.stderr
    return next(folder.glob("*.whl")), next(folder.glob("*.tar.gz")), python


def run_checked(*arguments, **options):
    """Run a program of an environment of this test's own."""
    return subprocess.run(arguments, capture_output=True, text=True, check=False, **options)  # noqa: S603


def environment_with_wheel(environment):
    venv.create(environment, with_pip=True)
    return environment / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


@pytest.mark.slow
def test_contents_and_sizes(wheel_file):
    wheel, sources, _ = wheel_file
    names = set(zipfile.ZipFile(wheel).namelist())
    begin = "reliab/shipped/datasets/"
    files_in_wheel = {name.removeprefix(begin) for name in names if name.startswith(begin)}
    assert drop_caches(list_shipped_files("datasets")) - files_in_wheel == NOT_IN_WHEEL
    assert {f"reliab/shipped/studies/{name}" for name in drop_caches(list_shipped_files("studies"))} <= names
    assert {"reliab/py.typed", "reliab/explore/web/main.js"} <= names
    assert not [name for name in names if "__pycache__" in name or name.startswith("tests/")]
    assert wheel.stat().st_size < LARGEST_WHEEL * MEGABYTE
    with tarfile.open(sources) as archive:
        files_in_wheel = {name.split("/", 1)[1] for name in archive.getnames() if "/" in name}
    assert {
        "pyproject.toml",
        "datasets/real_suite/results.nc",
        "tests/packaging/test_wheel.py",
    } <= files_in_wheel
    assert sources.stat().st_size < LARGEST_SOURCES * MEGABYTE


@pytest.mark.slow
def test_an_empty_environment_runs_the_main_job(wheel_file, tmp_path):
    python = environment_with_wheel(tmp_path / "venv")
    installing = run_checked(python, "-m", "pip", "install", "--quiet", wheel_file[0])
    assert installing.returncode == 0, installing.stderr
    (tmp_path / "empty").mkdir()
    environment = {**os.environ, "RELIAB_DATA": str(tmp_path / "data"), "PYTHONPATH": ""}
    reliab = partial(
        run_checked, python.with_name(f"reliab{python.suffix}"), cwd=tmp_path / "empty", env=environment
    )
    run = reliab("run", "--out", "run")
    assert run.returncode == 0, run.stderr
    assert (tmp_path / "empty" / "run" / "report.pdf").stat().st_size > 1000
    verdict = reliab("assess", "sample_test", "--f", "1", "--xi", "0.02", "--json", "-")
    assert json.loads(verdict.stdout)["verdict"] == "reliable"
    options = ("criterion", "--results", "real_suite", "--f", "0.75", "--xi", "0.02")
    missing = reliab(*options)
    assert missing.returncode == 2
    assert "reliab fetch" in missing.stderr
    output = reliab("fetch", ROOT / "datasets/real_suite/results.nc")
    assert output.returncode == 0, output.stderr
    assert reliab(*options).returncode == 0


@pytest.mark.slow
def test_the_first_pages_work_as_they_are_written(wheel_file):
    walk = run_checked(sys.executable, ROOT / "tests/packaging/new_user.py", wheel_file[0])
    assert walk.returncode == 0, walk.stderr


@pytest.mark.slow
def test_a_control_room_needs_few_packages(wheel_file, tmp_path):
    """What `assess` and `monitor` need is installed without a conflict, and is enough for them."""
    building = run_checked(wheel_file[2], ROOT / ".ci/release/core.py", tmp_path)
    assert building.returncode == 0, building.stderr
    python = environment_with_wheel(tmp_path / "venv")
    assert run_checked(python, "-m", "pip", "install", "--quiet", *tmp_path.glob("*.whl")).returncode == 0
    assert run_checked(python, "-m", "pip", "check").returncode == 0
    environment = {**os.environ, "RELIAB_DATA": str(tmp_path / "data"), "PYTHONPATH": ""}
    reliab = partial(run_checked, python.with_name(f"reliab{python.suffix}"), cwd=tmp_path, env=environment)
    options = ("sample_test", "--f", "1", "--xi", "0.02", "--json", "-")
    assert json.loads(reliab("assess", *options).stdout)["verdict"] == "reliable"
    assert json.loads(reliab("monitor", *options).stdout.splitlines()[-1])["kind"] == "end"
    criterion = reliab("criterion", "--ellipses", "real_suite")
    assert (criterion.returncode, "needs the package" in criterion.stderr) == (2, True)
