"""Whatever takes a `progress` reports every piece of its work, and ends at the total that it announced."""

import ast
import inspect
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from normal_values import NormalValues
from parsed import nodes

import reliab
from reliab.core.shipped import shipped
from reliab.core.vocabulary import Metric
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.methods.registry import method_of
from reliab.discrepancy import adding
from reliab.motions.loading import load_motions
from reliab.sampling.ensembles import Ensembles, sample
from reliab.simulation.frames.frame_file import frame_of_tables, read_structure
from reliab.structures.structure import Structure
from reliab.sweep.ellipse_table import EllipseRequest, measure_responses, predict_ellipses, trace_ellipses
from reliab.sweep.frame_table import FrameRequest, errors_of_rig, limits_of_coupling, trace_frame_ellipses
from reliab.sweep.request import ScaledGrid, SweepRequest
from reliab.sweep.run import run_sweep
from reliab.tracking.indices.window import Window
from reliab.validation.folds import k_fold
from reliab.validation.judge import DerivedCandidate, cross_validate, probability_calibration

PACKAGE = Path(reliab.__file__).parent
MOTIONS = load_motions("synthetic")[:2]
STRUCTURE = Structure(frequency=1.0, damping_ratio=0.05)
GRID = ScaledGrid(gain_steps=5, delay_steps=4, lead_steps=4)
VALUES = NormalValues(values=np.random.default_rng(1).normal(size=30))
QUICK = Ensembles(steps=40, thin=2, walkers=8)
REQUEST = EllipseRequest(frequencies=(1.0, 2.0), damping_ratios=(0.02, 0.05), thresholds=(0.02,))
FRAME = {
    "frame": {"masses_kg": [2000.0, 1500.0], "storey_stiffnesses_n_per_m": [4e5, 3e5]},
    "damping": {"ratio": 0.03},
    "specimen": {"degree_of_freedom": "1", "stiffness_n_per_m": 2e5},
    "transfer_system": {"gain": 0.98, "delay_ms": 1.0},
}


@pytest.fixture(scope="module")
def ellipses() -> xr.Dataset:
    """Ellipses of late actuators under twelve motions."""
    samples = np.random.default_rng(2).lognormal(0.0, 0.3, (12, 2, 2, 2, 1, 1, 1, 1))
    names = ("motion", "f", "xi", "threshold", "metric", "curve", "side")
    return xr.Dataset(
        {"a": (names, 2e-4 * samples[:, 0]), "b": (names, 3.0 * samples[:, 1])},
        coords={
            "motion": [f"M{place}" for place in range(12)],
            "event": ("motion", [f"E{place}" for place in range(12)]),
            "f": [1.0, 2.0],
            "xi": [0.02, 0.05],
            "threshold": [0.05],
            "metric": ["rms"],
            "curve": ["ellipse"],
            "side": ["lag"],
        },
    )


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("progress")
    return reliab.simulate(MOTIONS, f=[1.0, 2.0], xi=[0.02, 0.05], out=folder / "results.zarr")


def progress_of_chains(progress, ellipses):
    subset = ellipses.sel(f=[1.0], xi=[0.02])
    derive_criterion(subset, method="hierarchical", law="power", steps=40, progress=progress)


def progress_of_several_tests(progress):
    reliab.assess(["none.csv", "neither.csv", "nor.csv"], progress=progress)  # each is done with, if refused


def progress_of_added_tests(progress, tmp_path):
    reliab.add_to_rig(tmp_path / "rig", ["none.csv", "neither.csv", "nor.csv"], progress=progress)


def progress_of_posteriors(progress, monkeypatch):
    """Two of three blocks have effects; what is made of their posteriors is tested beside diagnoses."""
    blocks = [
        SimpleNamespace(
            block=SimpleNamespace(block=name), effects=effects, doubtful=(), problem=None, best=None
        )
        for name, effects in (("actuator", ("gain",)), ("balance", ()), ("specimen", ("backlash",)))
    ]
    for name in ("sample_posterior", "_apply_posterior", "update_model", "_shift", "replace"):
        monkeypatch.setattr(adding, name, lambda *_, **__: None)
    adding.add(SimpleNamespace(blocks=blocks), progress=progress)


def progress_of_folds(progress, ellipses):
    candidate = DerivedCandidate(name="quantile", method=method_of("quantile"))
    folds = k_fold(ellipses["event"].values, 3)
    cross_validate(ellipses, folds, [candidate], scheme="k", confidences=[0.5], trials=8, progress=progress)


def progress_of_shares(progress, tmp_path):
    results = reliab.simulate(MOTIONS, alpha=[0.5, 1.0], out=tmp_path / "results.zarr")
    results.reliab.ellipses(progress=progress)


FRAME_UNDER_TEST = frame_of_tables(FRAME, "frame.toml")
CASES = {
    "simulate": lambda progress, tmp_path: reliab.simulate(
        MOTIONS, out=tmp_path / "results.zarr", progress=progress
    ),
    "run_sweep": lambda progress, tmp_path: run_sweep(
        MOTIONS,
        SweepRequest(frequencies=(1.0,), damping_ratios=(0.02,), grid=GRID),
        tmp_path / "results.zarr",
        workers=1,
        progress=progress,
    ),
    "ellipses": lambda progress: reliab.ellipses(MOTIONS, threshold=0.02, progress=progress),
    "ellipses, stored": lambda progress, results: reliab.ellipses(results, progress=progress),
    "ellipses, of shares": progress_of_shares,
    "trace_ellipses": lambda progress: trace_ellipses(MOTIONS, REQUEST, progress=progress),
    "predict_ellipses": lambda progress: predict_ellipses(MOTIONS, REQUEST, progress=progress),
    "trace_frame_ellipses": lambda progress: trace_frame_ellipses(
        MOTIONS, FrameRequest(frame=FRAME_UNDER_TEST), progress=progress
    ),
    "measure_responses": lambda progress: measure_responses(MOTIONS, [1.0], [0.02], progress=progress),
    "limits_of_coupling": lambda progress: limits_of_coupling(
        read_structure(shipped("datasets", "frames/two_actuators.toml")),
        MOTIONS,
        threshold=0.05,
        metric=Metric.RMS,
        window=Window(),
        progress=progress,
    ),
    "errors_of_rig": lambda progress: errors_of_rig(
        FRAME_UNDER_TEST, MOTIONS, window=Window(), progress=progress
    ),
    "assess": progress_of_several_tests,
    "add_to_rig": progress_of_added_tests,
    "derive_criterion": progress_of_chains,
    "sample": lambda progress: sample(VALUES, QUICK, progress=progress),
    "probability_calibration": lambda progress, ellipses: probability_calibration(
        ellipses, trials=8, progress=progress
    ),
    "cross_validate": progress_of_folds,
    "add": progress_of_posteriors,
}
PASSED_ON = {  # by a case of the function that calls it
    "from_ellipses": "derive_criterion",
    "learn": "derive_criterion",
    "fit_hierarchical": "derive_criterion",
    "draw": "sample",
}
ELSEWHERE = {"diagnose": "discrepancy/test_progress.py"}


@pytest.mark.slow
@pytest.mark.default_cases(8)
@pytest.mark.filterwarnings("ignore::reliab.sampling.posterior_sample.ConvergenceWarning")
@pytest.mark.parametrize("name", CASES)
def test_every_piece_is_reported_once_and_the_last_is_the_total(name, request):
    calls = []
    work = CASES[name]
    fixtures = list(inspect.signature(work).parameters)[1:]
    work(lambda *call: calls.append(call), *map(request.getfixturevalue, fixtures))
    counts, totals = zip(*calls, strict=True)
    assert list(counts) == sorted(set(counts))
    assert set(totals) == {counts[-1]}


def test_whatever_takes_a_progress_has_a_case():
    takers = {
        node.name
        for file in PACKAGE.rglob("*.py")
        for node in nodes(file)
        if isinstance(node, ast.FunctionDef)
        and any(argument.arg == "progress" for argument in node.args.kwonlyargs)
    }
    names = {name.partition(",")[0] for name in CASES}
    assert takers == names | set(PASSED_ON) | set(ELSEWHERE)
    assert set(PASSED_ON.values()) <= names
