"""Every option of `reliab criterion` changes the answer, or is refused."""

import inspect
import json

import numpy as np
import pytest
import typer
import xarray as xr
from typer.testing import CliRunner

from reliab.app.cli.criterion import criterion
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.criterion.distributions import DISTRIBUTIONS
from reliab.criterion.laws.law import scales
from reliab.criterion.laws.registry import FITTED_LAWS, MANY_MOTION_LAWS
from reliab.criterion.methods.registry import METHODS
from reliab.motions.catalogue import write_suite
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.sweep.ellipse_dataset import write_ellipses
from reliab.sweep.request import ScaledGrid, SweepRequest
from reliab.sweep.run import run_sweep

app = typer.Typer()
app.command()(criterion)
TABLE2 = shipped("datasets", "paper/table2.csv")
FRAME = shipped("datasets", "frames/three_storeys.toml")
TWO = ("--structure", shipped("datasets", "frames/two_actuators.toml"))


def answer(*arguments):
    result = CliRunner().invoke(app, [str(argument) for argument in arguments] + ["--json", "-"])
    if isinstance(result.exception, InputError):
        return "refused"
    assert result.exception is None, result.exception
    return json.loads(result.stdout)


def motions(folder):
    """Six short ground motions of as many earthquakes, in a catalogue with two sets."""
    rng = np.random.default_rng(1)
    window = np.sin(np.linspace(0.0, np.pi, 160)) ** 2
    suite = [
        Motion(
            name=f"E{number}/H1",
            event=f"E{number}",
            set_name="near" if number < 3 else "far",
            acceleration=window * rng.normal(size=160).cumsum(),
            time_step=0.02,
        )
        for number in range(6)
    ]
    return write_suite(MotionSuite.from_motions(suite), folder)


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    """A file of ellipses with both sides and curves, stored results, and short ground motions."""
    folder = tmp_path_factory.mktemp("sources")
    rng = np.random.default_rng(2)
    f, xi, threshold = np.array([0.5, 1.0]), np.array([0.02, 0.05]), np.array([0.05, 0.1])
    shape = (24, 2, 2, 2, 2, 2, 2)
    spread = rng.normal(size=(24, 1, 1, 1, 1, 1, 1)) + 0.2 * rng.normal(size=shape)
    scale = [row[:, :, None, None, None, None] for row in scales(f[:, None], xi[None, :])]
    growth = (threshold[:, None, None, None] / 0.05) ** 2
    dims = ("motion", "f", "xi", "threshold", "metric", "curve", "side")
    dataset = xr.Dataset(
        {
            name: (dims, row * growth * np.exp(0.4 * spread + 0.1 * rng.normal(size=shape)))
            for name, row in zip("ab", scale, strict=True)
        },
        coords={
            "motion": [f"E{m}" for m in range(24)],
            "event": ("motion", [f"E{m}" for m in range(24)]),
            "f": f,
            "xi": xi,
            "threshold": threshold,
            "metric": ["rms", "mte"],
            "curve": ["ellipse", "inscribed"],
            "side": ["lag", "lead"],
        },
        attrs={"window": "record", "experimental_fraction": 1.0},
    )
    write_ellipses(dataset, folder / "ellipses.nc")
    motions(folder / "motions")
    grid = ScaledGrid(gain_steps=14, delay_steps=20)
    request = SweepRequest(frequencies=(1.0,), damping_ratios=(0.05,), grid=grid)
    run_sweep(load_motions(str(folder / "motions")), request, folder / "results.zarr")
    return folder


FILE = ("--ellipses", "{folder}/ellipses.nc", "--f", "1", "--xi", "0.02")
PAPER = ("--ellipses", TABLE2)
RECORDS = ("--motions", "{folder}/motions", "--method", "quantile", "--confidence", "0.8")
HALF = (*RECORDS[:-1], "0.6", "--sets", "near")
STORE = ("--results", "{folder}/results.zarr", "--confidence", "0.7")
SHIPPED_SOURCE = ("--ellipses", "real_suite", "--f", "1", "--xi", "0.02")
PUBLISHED_LAW = ("--law", "guo_2017_18")
CHANGES = {
    "motions": [(PUBLISHED_LAW, (*RECORDS, "--law", "table"))],
    "sets": [(RECORDS, ("--sets", "near", "--confidence", "0.6"))],
    "results": [(PUBLISHED_LAW, (*STORE, "--law", "table"))],
    "ellipses": [(PUBLISHED_LAW, (*PAPER, "--law", "table"))],
    "f": [
        (FILE[:2], ("--f", "1")),
        (FILE[:2], ("--f", "0.7")),
        (PUBLISHED_LAW, ("--f", "2")),
        (RECORDS, ("--f", "2")),
    ],
    "xi": [(FILE[:2], ("--xi", "0.05")), (PUBLISHED_LAW, ("--xi", "0.05")), (RECORDS, ("--xi", "0.05"))],
    "threshold": [
        (FILE, ("--threshold", "0.1")),
        (RECORDS, ("--threshold", "0.02")),
        (STORE, ("--threshold", "0.02")),
    ],
    "confidence": [(FILE, ("--confidence", "0.9")), (PAPER, ("--confidence", "0.9"))],
    "metric": [(FILE, ("--metric", "mte")), (RECORDS, ("--metric", "mte")), (STORE, ("--metric", "mte"))],
    "window": [(RECORDS, ("--window", "1.5")), (RECORDS, ("--window", "arias"))],
    "alpha": [(RECORDS, ("--alpha", "0.5")), (FILE, ("--alpha", "0.5")), (STORE, ("--alpha", "0.6"))],
    "duration": [(SHIPPED_SOURCE, ("--duration", "20"))],
    "motion": [(SHIPPED_SOURCE, ("--motion", "{folder}/motions"))],
    "suite": [(SHIPPED_SOURCE, ("--suite", "{folder}/motions"))],
    "model": [],
    "structure": [(HALF, ("--structure", FRAME))],
    "actuator": [((*HALF, *TWO), ("--actuator", "1"))],
    "method": [
        (FILE, ("--method", name)) for name in ("quantile", "tolerance", "order_statistic", "predictive")
    ],
    "assurance": [((*FILE, "--method", "tolerance"), ("--assurance", "0.8"))],
    "distribution": [((*FILE, "--method", "quantile"), ("--distribution", "weibull"))],
    "joint": [(FILE, ("--each",)), ((*FILE, "--method", "quantile"), ("--joint",))],
    "law": [
        (FILE, ("--law", "power")),
        (FILE, ("--law", "dimensionless")),
        (PUBLISHED_LAW, ("--law", "guo_2017_12")),
    ],
    "steps": [],
    "chains": [],
    "figures": [],
    "out": [],
    "json_target": [],
}
SLOW = {"suite", "motion", "duration"}  # options that carry the criterion of all that ships
UNUSABLE = {
    "motions": [(PAPER, ("--motions", "synthetic")), (PUBLISHED_LAW, ("--motions", "synthetic"))],
    "sets": [(PAPER, ("--sets", "near")), (PUBLISHED_LAW, ("--sets", "near")), (STORE, ("--sets", "near"))],
    "results": [(FILE, ("--results", "real_suite")), (PUBLISHED_LAW, ("--results", "real_suite"))],
    "ellipses": [(PUBLISHED_LAW, PAPER), (STORE, PAPER)],
    "f": [
        (PAPER, ("--f", "2")),
        (FILE[:2], ("--f", "5")),
        (FILE[:2], ("--f", "0")),
        (PUBLISHED_LAW, ("--f", "3")),
    ],
    "xi": [(PAPER, ("--xi", "0.05")), (FILE[:2], ("--xi", "0.5")), (PUBLISHED_LAW, ("--xi", "0.2"))],
    "threshold": [
        *(
            (base, ("--threshold", wrong))
            for base in (PAPER, FILE, STORE, PUBLISHED_LAW)
            for wrong in ("0", "-0.1", "nan")
        ),
        *((base, ("--threshold", "0.01")) for base in (PAPER, FILE, PUBLISHED_LAW)),
        (RECORDS, ("--threshold", "0")),
    ],
    "confidence": [
        (base, ("--confidence", wrong)) for base in (FILE, PAPER, PUBLISHED_LAW) for wrong in ("0", "95")
    ],
    "metric": [
        (PAPER, ("--metric", "mte")),
        (PUBLISHED_LAW, ("--metric", "mte")),
        (FILE, ("--metric", "mean")),
    ],
    "window": [
        (FILE, ("--window", "arias")),
        (PAPER, ("--window", "arias")),
        (PUBLISHED_LAW, ("--window", "arias")),
    ],
    "alpha": [
        *((base, ("--alpha", "0.5")) for base in (PAPER, PUBLISHED_LAW)),
        *((base, ("--alpha", wrong)) for base in (FILE, STORE) for wrong in ("0.1", "1.5")),
    ],
    "duration": [
        (PAPER, ("--duration", "20")),
        (PUBLISHED_LAW, ("--duration", "20")),
        (SHIPPED_SOURCE, ("--duration", "0")),
        (SHIPPED_SOURCE, ("--duration", "20", "--suite", "{folder}/motions")),
    ],
    "motion": [(FILE, ("--motion", "{folder}/motions")), (PUBLISHED_LAW, ("--motion", "{folder}/motions"))],
    "suite": [
        (PUBLISHED_LAW, ("--suite", "{folder}/motions")),
        ((*SHIPPED_SOURCE[:2], "--f", "0.8", "--xi", "0.02"), ("--suite", "{folder}/motions")),
    ],
    "model": [(base, ("--model", "{folder}/model.toml")) for base in (FILE, PAPER, STORE, PUBLISHED_LAW)],
    "structure": [
        *((base, ("--structure", FRAME)) for base in (FILE, PAPER, STORE, PUBLISHED_LAW)),
        *((RECORDS, ("--structure", FRAME, *extra)) for extra in (("--f", "1"), ("--alpha", "0.5"))),
        (RECORDS, ("--structure", "{folder}/none.toml")),
    ],
    "actuator": [(RECORDS, ("--actuator", "1")), ((*RECORDS, *TWO), ("--actuator", "3"))],
    "method": [(FILE, ("--method", "magic")), (PUBLISHED_LAW, ("--method", "dirichlet"))],
    "assurance": [(FILE, ("--assurance", "0.9")), (PUBLISHED_LAW, ("--assurance", "0.9"))],
    "distribution": [(FILE, ("--distribution", "weibull")), (PUBLISHED_LAW, ("--distribution", "weibull"))],
    "joint": [(PUBLISHED_LAW, ("--joint",))],
    "law": [(FILE, ("--law", "magic")), (FILE, ("--law", "guo_2017_12"))],
    "steps": [(FILE, ("--steps", "40")), (PUBLISHED_LAW, ("--steps", "40"))],
    "chains": [(FILE, ("--chains", "chains.h5")), (PUBLISHED_LAW, ("--chains", "chains.h5"))],
    "figures": [(PUBLISHED_LAW, ("--figures", "{folder}/figures")), (PAPER, ("--figures", TABLE2))],
    "out": [(PAPER, ("--out", "{folder}/none/criterion.json"))],
    "json_target": [],
}


def place_sources(arguments, folder):
    return [str(argument).format(folder=folder) for argument in arguments]


def cases(table):
    return [
        pytest.param(base, extra, id=f"{name}-{number}", marks=[pytest.mark.slow] if name in SLOW else [])
        for name, pairs in table.items()
        for number, (base, extra) in enumerate(pairs)
    ]


def test_the_walk_meets_every_option():
    options = set(inspect.signature(criterion).parameters) - {"context", "list_all", "details"}
    assert set(CHANGES) == set(UNUSABLE) == options
    tested_elsewhere = {"model", "steps", "chains", "figures", "out", "json_target"}
    assert all(CHANGES[name] or name in tested_elsewhere for name in options)


@pytest.mark.default_cases(20)
@pytest.mark.parametrize(("base", "extra"), cases(UNUSABLE))
def test_an_unusable_option_is_refused(sources, base, extra):
    assert answer(*place_sources(base, sources), *place_sources(extra, sources)) == "refused"


@pytest.fixture(scope="module")
def answers(sources):
    """Answers by their arguments, each asked for once."""
    cache = {}

    def ask(arguments):
        key = tuple(place_sources(arguments, sources))
        if key not in cache:
            cache[key] = answer(*key)
        return cache[key]

    return ask


@pytest.mark.slow
@pytest.mark.default_cases(8)
@pytest.mark.parametrize(("base", "extra"), cases(CHANGES))
def test_an_accepted_option_changes_the_answer(answers, base, extra):
    original, variant = answers(base), answers((*base, *extra))
    assert original != "refused"
    assert variant != "refused"
    assert numbers(original) != numbers(variant)


def numbers(found):
    """Limits, and what was drawn or compared."""
    return [
        [[row[name] for name in ("a", "b", "a_lead", "b_lead", "f", "xi")] for row in found["criteria"]],
        sorted(set(found) & {"figures", "comparison"}),
    ]


def test_a_model_goes_to_the_simulation(sources, monkeypatch):
    from reliab.app.api import sources as source_of_ellipses
    from reliab.sweep.ellipse_dataset import open_ellipses

    calls = {}

    def ellipses(suite, **options):
        calls.update(options, motions=len(suite))
        return open_ellipses(sources / "ellipses.nc")

    monkeypatch.setattr(source_of_ellipses, "ellipses", ellipses)
    answer("--motions", sources / "motions", "--model", sources / "model.toml")
    assert (calls["motions"], calls["model"]) == (6, sources / "model.toml")


def test_a_list_names_every_method_law_and_distribution_and_takes_no_other_option():
    output = CliRunner().invoke(app, ["--list"]).stdout
    for name in (*METHODS, *FITTED_LAWS, *MANY_MOTION_LAWS, *DISTRIBUTIONS):
        assert f"  {name}: " in output
    assert "guo_2017_18: (A − 1)²/(0.021ξ)" in output
    assert answer("--list", "--f", 1) == "refused"
