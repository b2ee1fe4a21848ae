"""Every reader, and what must hold whatever stands in the files."""

import contextlib
import io
import json
import math
import resource
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

import numpy as np
import typer

from fuzz import corpus
from fuzz.damage import SECRET, DamagedCase, secret_of, write
from reliab.app.cli import application, read_defaults, run
from reliab.core.errors import IncompleteError, InputError
from reliab.core.files import ordinary
from reliab.criterion.criterion import Criterion
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.motions.checking import inspect
from reliab.motions.loading import load_motions
from reliab.recordings.channels_file import read_channels_file
from reliab.recordings.reading import read_recording
from reliab.recordings.record import check_record
from reliab.sampling.ensembles import draw
from reliab.simulation.frames.frame_file import read_frame
from reliab.simulation.frames.transfer_table import read_matlab
from reliab.simulation.hybrid_test.model_file import read_model
from reliab.study.running import read_study
from reliab.study.stages import date_of, software_provenance, study_of
from reliab.sweep.results import open_results
from reliab.sweep.run import run_sweep

_LONGEST_MESSAGE = 4000
_MEMORY = 1 << 30
_CODES = (0, 1, 2, 3)
_PROBE = "hdf5_probe.py"  # another process reads a file of HDF5 first, and runs nothing else
_DANGEROUS = ("os.system", "os.exec", "os.posix_spawn", "subprocess.Popen", "socket.connect")


@dataclass(frozen=True, kw_only=True)
class Target:
    """A reader with sound files.

    Parameters
    ----------
    seeds : callable
        Returns the sound cases.
    read : callable
        Reads the case in a folder; raises an `InputError` where the case is refused.
    """

    seeds: Callable[[], list[corpus.Case]]
    read: Callable[[Path], object]


def examine(target: Target, case: DamagedCase) -> bool:
    """Read a case: a result or one clear error, without a warning and without running what is in the files.

    Returns
    -------
    bool
        Whether there was a result.
    """
    canary = Path(tempfile.gettempdir()) / corpus.CANARY
    with tempfile.TemporaryDirectory() as name, warnings.catch_warnings():
        folder = Path(name)
        write(case, folder)
        warnings.simplefilter("error")
        try:
            with _watch(), _bound_memory():
                target.read(folder)
        except (InputError, IncompleteError) as error:
            message = str(error)
            assert 0 < len(message) < _LONGEST_MESSAGE, message[:200]
            return False
        finally:
            assert not canary.exists()
            secret = secret_of(folder)
            if secret.exists():
                content = secret.read_bytes()
                secret.unlink()
                assert content == SECRET
    return True


_watching = False


def _hook(event: str, arguments: tuple[object, ...]) -> None:
    if (
        _watching
        and event in _DANGEROUS
        and not (event == "subprocess.Popen" and _PROBE in str(arguments[1]))
    ):
        raise AssertionError(event)


sys.addaudithook(_hook)


@contextlib.contextmanager
def _watch() -> Iterator[None]:
    """Fail where a process is started or a connection opened."""
    global _watching  # noqa: PLW0603 - an audit hook cannot be removed
    _watching = True
    try:
        yield
    finally:
        _watching = False


@contextlib.contextmanager
def _bound_memory() -> Iterator[None]:
    """Let what is read take 1 GB more address space than there was before."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limits = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + _MEMORY, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, limits)


def _command(*arguments: object) -> str:
    """Run a command line in this process; its output, or an error with its message."""
    output, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
        code = run([str(argument) for argument in arguments])
    assert code in _CODES, code
    assert "Traceback" not in errors.getvalue()
    if code in (2, 3):
        assert errors.getvalue().strip()
        raise InputError(errors.getvalue())
    _check_finite(output.getvalue())
    return output.getvalue()


def _check_finite(text: str) -> None:
    for line in text.splitlines() if "\n{" in text.strip() else [text]:
        json.loads(line, parse_constant=_refuse)


def _refuse(constant: str) -> float:
    raise AssertionError(constant)


def _motions(folder: Path) -> None:
    faults = inspect(folder).faults
    assert all(fault.rule and fault.file for fault in faults)
    for path in folder.iterdir():
        for motion in load_motions(path):
            assert np.isfinite(motion.acceleration).all()


def _catalogue(folder: Path) -> None:
    inspect(folder)
    for motion in load_motions(folder):
        assert np.isfinite(motion.acceleration).all()


def _assess(folder: Path) -> None:
    _command("assess", folder / "test.csv", "--f", "1", "--xi", "0.02", "--json", "-")


def _monitor(folder: Path) -> None:
    _command(
        *("monitor", folder / "test.csv", "--f", "1", "--xi", "0.02", "--wait", "0.01", "--every", "2"),
        *("--start-within", "0.1"),
        *("--json", "-"),
    )


def _recording(folder: Path) -> None:
    test = read_recording(folder / "test")
    assert np.isfinite(test.command).all()
    assert np.isfinite(test.measured).all()
    json.dumps([channel.summary() for channel in test.channels], allow_nan=False)


def _campaign(folder: Path) -> None:
    campaign = read_campaign(folder)
    for test in campaign.tests:
        for values in test.channels.values():
            assert np.isfinite(values).all()
    assert campaign.training
    assert campaign.proof


def _diagnose(folder: Path) -> None:
    _command("diagnose", folder, "--json", "-")


def _criterion_of(name: str) -> Callable[[Path], None]:
    def read(folder: Path) -> None:
        _command("criterion", "--ellipses", folder / name, "--confidence", "0.8", "--json", "-")

    return read


def _criterion(folder: Path) -> None:
    try:
        text = ordinary(folder / "criterion.json").read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("Cannot read the file", value=str(error)) from error
    criterion = Criterion.from_json(text)
    a, b = criterion.limits(1.0, 0.02)
    assert math.isfinite(float(a))
    assert math.isfinite(float(b))
    assert Criterion.from_json(criterion.to_json()).to_json() == criterion.to_json()


def _assess_with_criterion(folder: Path) -> None:
    write({"test.csv": corpus.tests()[0]["test.csv"]}, folder)
    _command(
        *("assess", folder / "test.csv", "--f", "1", "--xi", "0.02", "--json", "-"),
        *("--criterion", folder / "criterion.json"),
    )


def _manifest(folder: Path) -> None:
    assert isinstance(study_of(folder), dict)
    assert date_of(folder).year
    json.dumps(software_provenance(folder))


def _defaults(folder: Path) -> None:
    with mock.patch.dict("os.environ", {"RELIAB_CONFIG": str(folder / "reliab.toml")}):
        read_defaults(lambda: typer.main.get_command(application()))


def _chains(folder: Path) -> None:
    posterior = draw(corpus.CHAIN_MODEL, corpus.CHAIN_SETTINGS, file=folder / "chains.h5", group="run")
    assert np.isfinite(posterior.draws).all()


def _results(folder: Path) -> None:
    open_results(folder / "results.zarr")
    _command("ellipses", "--results", folder / "results.zarr", "--json", "-")


def _resume(folder: Path) -> None:
    run_sweep(corpus.suite(), corpus.REQUEST, folder / "results.zarr", resume=True)
    sound = open_results(folder / "results.zarr")
    assert np.isfinite(sound["rms"].values).any()


TARGETS = {
    "motions": Target(seeds=corpus.motions, read=_motions),
    "catalogue": Target(seeds=corpus.catalogue, read=_catalogue),
    "assess": Target(seeds=corpus.tests, read=_assess),
    "monitor": Target(seeds=lambda: corpus.tests()[:3], read=_monitor),
    "recording": Target(seeds=corpus.recordings, read=_recording),
    "record": Target(seeds=corpus.records, read=lambda folder: check_record(folder / "test")),
    "channels": Target(
        seeds=corpus.channels, read=lambda folder: read_channels_file(folder / "channels.toml")
    ),
    "campaign": Target(seeds=corpus.campaign, read=_campaign),
    "study": Target(seeds=corpus.studies, read=lambda folder: read_study(folder / "study.toml")),
    "ellipse_table": Target(seeds=corpus.ellipse_tables, read=_criterion_of("ellipses.csv")),
    "ellipse_file": Target(seeds=corpus.ellipse_files, read=_criterion_of("ellipses.nc")),
    "criterion": Target(seeds=corpus.criteria, read=_criterion),
    "assess_with_criterion": Target(seeds=corpus.criteria, read=_assess_with_criterion),
    "model": Target(seeds=corpus.models, read=lambda folder: read_model(folder / "model.toml")),
    "frame": Target(seeds=corpus.frames, read=lambda folder: read_frame(folder / "frame.toml")),
    "plant": Target(seeds=corpus.plants, read=lambda folder: read_matlab(folder / "plant.mat")),
    "manifest": Target(seeds=corpus.manifests, read=_manifest),
    "defaults": Target(seeds=corpus.defaults, read=_defaults),
    "chains": Target(seeds=corpus.chains, read=_chains),
    "results": Target(seeds=corpus.stores, read=_results),
    "resume": Target(seeds=corpus.stores, read=_resume),
}
"""By name; each in under a tenth of a second for one case, as a rule."""

SLOW_TARGETS = {"diagnose": Target(seeds=corpus.campaign, read=_diagnose)}
"""Those of seconds for one case, which only `run.py` tries."""
