"""What a command imports before its first answer: heavy parts of SciPy are not among it."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

TEST = str(Path(__file__).resolve().parents[3] / "datasets/sample_test/test.csv")
STRUCTURE = ("--f", "1", "--xi", "0.02")
DRAWING = {"matplotlib", "seaborn", "typst"}
SPARED_BY_ALL = DRAWING | {"emcee", "zarr", "arviz_stats", "scipy.stats", "scipy.signal"}
SPARED_BY_HELP = SPARED_BY_ALL | {"numpy", "scipy", "pandas", "xarray", "numba", "h5py"}
SPARED_BY_VERDICTS = SPARED_BY_ALL | {"pandas", "xarray"}
SPARED_BY_VERDICTS |= {f"scipy.{name}" for name in ("interpolate", "optimize", "integrate")}
COMPILER = {"numba.typed.typeddict", "numba.np.linalg"}  # of what Numba needs to compile
SPARED_BY_VERDICTS |= COMPILER
FILE_MODULES = {"recordings.channels_file", "criterion.criterion_file"}  # which are checked by pydantic
STRUCTURE_MODULES = FILE_MODULES | {
    "simulation.frames",
    "simulation.hybrid_test",
    "simulation.engine",
    "effects.registry",
}
SPARED_BY_ONE = SPARED_BY_VERDICTS | {f"reliab.{name}" for name in STRUCTURE_MODULES}
SPARED_BY_ONE |= {"reliab.sampling.ensembles", "reliab.assessment.measured_specimen.rebuild"}
SPARED_BY_ONE |= {"threadpoolctl", "rich.progress"}

SCRIPT = """
import io, json, sys
from contextlib import redirect_stdout
from reliab.app.cli import main
code = 0
with redirect_stdout(io.StringIO()):
    try:
        main()
    except SystemExit as end:
        code = end.code or 0
print(json.dumps([code, sorted(sys.modules)]))
"""


def modules(*arguments):
    """Names of all modules that a command has imported in a process of its own, where it answers.

    One that has compiled a kernel is asked once more.
    """
    names = imports_of(*arguments)
    return names if names.isdisjoint(COMPILER) else imports_of(*arguments)


def imports_of(*arguments):
    process = subprocess.run(  # noqa: S603 - this very package
        [sys.executable, "-c", SCRIPT, *arguments], capture_output=True, text=True, check=True
    )
    code, names = json.loads(process.stdout.splitlines()[-1])
    assert code == 0, process.stderr
    return set(names)


@pytest.fixture
def files(tmp_path):
    """The test under another name, since one that is given twice is refused, with a force, and a record."""
    table = pd.read_csv(TEST, comment="#")
    force_table = table.assign(force_N=4e4 * table.filter(like="measured").iloc[:, 0])
    force_table.to_csv(tmp_path / "with_force.csv", index=False)
    return {
        "AGAIN": shutil.copy(TEST, tmp_path / "again.csv"),
        "WITH_FORCE": tmp_path / "with_force.csv",
        "RECORD": tmp_path / "record.nc",
    }


@pytest.mark.slow
def test_a_verdict_needs_none_of_the_heavy_parts():
    assert modules("assess", TEST, *STRUCTURE) & SPARED_BY_ONE == set()


def test_a_verdict_in_python_needs_no_command_line():
    code = (
        f"import json, sys, reliab; reliab.assess({TEST!r}, f=1, xi=0.02); print(json.dumps([*sys.modules]))"
    )
    process = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)  # noqa: S603
    assert {"typer", "rich", "pydantic"} & set(json.loads(process.stdout)) == set()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "unneeded"),
    [
        (("--help",), SPARED_BY_HELP),
        (("assess", "--help"), SPARED_BY_HELP),
        (("monitor", TEST, *STRUCTURE), SPARED_BY_VERDICTS),
        (("assess", TEST, *STRUCTURE, "--exact"), SPARED_BY_VERDICTS),
        (("assess", "WITH_FORCE", *STRUCTURE), SPARED_BY_VERDICTS),
        (("assess", TEST, "AGAIN", *STRUCTURE), SPARED_BY_VERDICTS),
        (("compare", TEST, "AGAIN", *STRUCTURE), SPARED_BY_VERDICTS),
        (("record", TEST, "--out", "RECORD"), SPARED_BY_ALL),
    ],
    ids=lambda value: " ".join(item for item in value if len(item) < 20) if isinstance(value, tuple) else "",
)
def test_no_command_imports_unneeded_modules(arguments, unneeded, files):
    assert modules(*(str(files.get(argument, argument)) for argument in arguments)) & unneeded == set()
