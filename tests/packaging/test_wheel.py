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


def shipped_files(kind):
    return {path.relative_to(ROOT / kind).as_posix() for path in (ROOT / kind).rglob("*") if path.is_file()}


def without_caches(names):
    return {name for name in names if "__pycache__" not in name}


def test_every_dataset_is_named_for_the_wheel():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    named = project["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]
    sources = [ROOT / name for name in named if name.startswith("datasets/")]
    included = {
        file.relative_to(ROOT / "datasets").as_posix()
        for path in sources
        for file in (path.rglob("*") if path.is_dir() else [path])
        if file.is_file()
    }
    assert without_caches(shipped_files("datasets") - included) == NOT_IN_WHEEL
    assert all(path.exists() for path in sources)


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Wheel, source distribution, and the Python that can build them."""
    folder = tmp_path_factory.mktemp("dist")
    environment = tmp_path_factory.mktemp("build") / "venv"
    python = made(environment)
    assert called(python, "-m", "pip", "install", "--quiet", "build").returncode == 0
    building = called(python, "-m", "build", "--outdir", folder, ROOT)
    assert building.returncode == 0, building.stderr
    return next(folder.glob("*.whl")), next(folder.glob("*.tar.gz")), python


def called(*arguments, **options):
    """Run a program of an environment of this test's own."""
    return subprocess.run(arguments, capture_output=True, text=True, check=False, **options)  # noqa: S603


def made(environment):
    venv.create(environment, with_pip=True)
    return environment / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


@pytest.mark.slow
def test_contents_and_sizes(built):
    wheel, sources, _ = built
    names = set(zipfile.ZipFile(wheel).namelist())
    begin = "reliab/shipped/datasets/"
    inside = {name.removeprefix(begin) for name in names if name.startswith(begin)}
    assert without_caches(shipped_files("datasets")) - inside == NOT_IN_WHEEL
    assert {f"reliab/shipped/studies/{name}" for name in without_caches(shipped_files("studies"))} <= names
    assert {"reliab/py.typed", "reliab/explore/web/main.js"} <= names
    assert not [name for name in names if "__pycache__" in name or name.startswith("tests/")]
    assert wheel.stat().st_size < LARGEST_WHEEL * MEGABYTE
    with tarfile.open(sources) as archive:
        inside = {name.split("/", 1)[1] for name in archive.getnames() if "/" in name}
    assert {"pyproject.toml", "datasets/real_suite/results.nc", "tests/packaging/test_wheel.py"} <= inside
    assert sources.stat().st_size < LARGEST_SOURCES * MEGABYTE


@pytest.mark.slow
def test_an_empty_environment_runs_the_main_job(built, tmp_path):
    python = made(tmp_path / "venv")
    installing = called(python, "-m", "pip", "install", "--quiet", built[0])
    assert installing.returncode == 0, installing.stderr
    (tmp_path / "empty").mkdir()
    environment = {**os.environ, "RELIAB_DATA": str(tmp_path / "data"), "PYTHONPATH": ""}
    reliab = partial(
        called, python.with_name(f"reliab{python.suffix}"), cwd=tmp_path / "empty", env=environment
    )
    run = reliab("run", "--out", "run")
    assert run.returncode == 0, run.stderr
    assert (tmp_path / "empty" / "run" / "report.pdf").stat().st_size > 1000
    verdict = reliab("assess", "sample_test", "--f", "1", "--xi", "0.02", "--json", "-")
    assert json.loads(verdict.stdout)["verdict"] == "reliable"
    asked = ("criterion", "--results", "real_suite", "--f", "0.75", "--xi", "0.02")
    missing = reliab(*asked)
    assert missing.returncode == 2
    assert "reliab fetch" in missing.stderr
    fetched = reliab("fetch", ROOT / "datasets/real_suite/results.nc")
    assert fetched.returncode == 0, fetched.stderr
    assert reliab(*asked).returncode == 0


@pytest.mark.slow
def test_the_first_pages_work_as_they_are_written(built):
    followed = called(sys.executable, ROOT / "tests/packaging/new_user.py", built[0])
    assert followed.returncode == 0, followed.stderr


@pytest.mark.slow
def test_a_control_room_needs_few_packages(built, tmp_path):
    """What `assess` and `monitor` need is installed without a conflict, and is enough for them."""
    building = called(built[2], ROOT / ".ci/release/core.py", tmp_path)
    assert building.returncode == 0, building.stderr
    python = made(tmp_path / "venv")
    assert called(python, "-m", "pip", "install", "--quiet", *tmp_path.glob("*.whl")).returncode == 0
    assert called(python, "-m", "pip", "check").returncode == 0
    environment = {**os.environ, "RELIAB_DATA": str(tmp_path / "data"), "PYTHONPATH": ""}
    reliab = partial(called, python.with_name(f"reliab{python.suffix}"), cwd=tmp_path, env=environment)
    asked = ("sample_test", "--f", "1", "--xi", "0.02", "--json", "-")
    assert json.loads(reliab("assess", *asked).stdout)["verdict"] == "reliable"
    assert json.loads(reliab("monitor", *asked).stdout.splitlines()[-1])["kind"] == "end"
    criterion = reliab("criterion", "--ellipses", "real_suite")
    assert (criterion.returncode, "needs the package" in criterion.stderr) == (2, True)
