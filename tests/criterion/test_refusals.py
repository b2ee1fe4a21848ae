"""What no criterion can be derived from is refused, by its own rule."""

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from reliab.core.errors import InputError
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.criterion.laws.law import validate_coefficients, validate_grid
from reliab.criterion.methods.hierarchical.fit import HierarchicalFit, hierarchical_model
from reliab.criterion.methods.quantile import Quantile
from reliab.criterion.population import EllipseSample, Population

A, B = np.array([1e-4, 2e-4, 3e-4]), np.array([1.0, 2.0, 4.0])
EVENTS = np.array(["E1", "E2", "E3"])


def sample(**variant):
    structure = {"frequency": 1.0, "damping_ratio": 0.02, "threshold": 0.05, "metric": "rms"}
    return EllipseSample(**{"a": A, "b": B, "motions": EVENTS, "events": EVENTS, **structure, **variant})


def ellipses(**names):
    sizes = {"curve": ["ellipse"], "side": ["lag"], **names}
    dimensions = ("motion", "f", "xi", "threshold", "metric", *sizes)
    shape = (3, 1, 1, 1, 1, *(len(values) for values in sizes.values()))
    return xr.Dataset(
        {
            name: (dimensions, np.broadcast_to(values.reshape(3, *(1,) * (len(shape) - 1)), shape))
            for name, values in (("a", A), ("b", B))
        },
        coords={
            "motion": EVENTS,
            "event": ("motion", EVENTS),
            "f": [1.0],
            "xi": [0.02],
            "threshold": [0.05],
            "metric": ["rms"],
            **sizes,
        },
    )


def population(**variant):
    parts = {"events": EVENTS, "frequencies": np.array([1.0]), "damping_ratios": np.array([0.02])}
    logarithms = {"log_alpha": np.log(A).reshape(3, 1, 1), "log_beta": np.log(B).reshape(3, 1, 1)}
    return Population(**{**parts, **logarithms, **variant})


derive = partial(derive_criterion, method="quantile")


@pytest.mark.parametrize(
    ("make", "rule"),
    [
        (lambda: sample(a=A[:1], b=B[:1]), "Too few ground motions.*found 1"),
        (lambda: sample(a=A * [1.0, 0.0, 1.0]), "E2: .* parameter a must be between .*; found 0.0"),
        (
            lambda: sample(b=B * [1.0, 1.0, np.inf]),
            "E3: .* parameter b must be between .* found inf",
        ),
        (
            lambda: sample(b=np.full(3, 2.0)),
            "b is the same for all ground motions; found 3 times 2",
        ),
        (
            lambda: derive(ellipses(side=["lead"])),
            "boundaries of late actuators; found ellipses of lead alone",
        ),
        (lambda: validate_coefficients("a", [1.0, np.nan], 2), "coefficients of a must be 2 finite numbers"),
        (lambda: validate_coefficients("b", [1.0], 2), "coefficients of b must be 2 finite numbers"),
        (lambda: validate_coefficients("b", [[1.0], [1.0, 2.0]], 2), "in rows of one length"),
        (lambda: validate_grid("frequencies", [2.0, 1.0]), "frequencies of a law must be positive"),
        (lambda: validate_grid("frequencies", []), "frequencies of a law must be positive"),
        (
            lambda: Quantile(distribution="gumbel of nobody"),
            "Unknown distribution; found gumbel of nobody",
        ),
        (lambda: population(log_alpha=np.log(A).reshape(3, 1, 1) - 1e4), "Logarithms .* must be between"),
        (lambda: population(log_beta=np.log(B).reshape(1, 3, 1)), "a pair of ellipse parameters for each"),
        (lambda: population(log_beta=np.full((3, 1, 1), np.nan)), "a pair of ellipse parameters for each"),
    ],
)
def test_each_rule_refuses_its_violation(make, rule):
    with pytest.raises(InputError, match=rule):
        make()


def test_a_table_without_rows_is_refused(tmp_path):
    (tmp_path / "ellipses.csv").write_text("motion,a,b\n")
    with pytest.raises(InputError, match="table has no rows"):
        read_ellipses(tmp_path / "ellipses.csv")


def test_missing_curve_is_refused_with_and_without_dimension():
    for content in (ellipses(curve=["cosine"]), ellipses(curve=["cosine"]).isel(curve=0)):
        with pytest.raises(InputError, match="cosine"):
            derive(content)


def test_motions_without_an_ellipse_somewhere_do_not_count_in_the_hierarchical_model():
    """Each structure has three of four motions, but only two have an ellipse at both."""
    values = np.arange(8.0).reshape(4, 2, 1)
    values[0, 0] = values[1, 1] = np.nan
    gaps = population(
        events=np.array(["E1", "E2", "E3", "E4"]),
        frequencies=np.array([1.0, 2.0]),
        log_alpha=values,
        log_beta=2.0 * values,
    )
    with pytest.raises(InputError, match=r"with an ellipse at every structure.*found 2"):
        hierarchical_model(gaps)


def test_missing_ellipses_are_counted_and_named_once():
    """Of five motions one has no ellipse at one of two structures and one has none at all."""
    values = np.arange(10.0).reshape(5, 2, 1)
    values[0, 0], values[1] = np.nan, np.nan
    gaps = SimpleNamespace(log_alpha=values, log_beta=2.0 * values)
    text_by_count = {}
    for motion_count in (4, 5):
        model = SimpleNamespace(values=np.zeros((motion_count, 2, 1, 2)))
        grid = SimpleNamespace(population=gaps)
        fit = HierarchicalFit(grid=grid, method="", assurance=None, model=model, posterior=None)
        text_by_count[motion_count] = fit._imputation_note  # noqa: SLF001 - one of the cautions
    assert text_by_count[4].startswith(
        "2 of 5 motions have no ellipse at some structure, 30.0 % of all values;"
    )
    assert text_by_count[4].endswith("; 1 with none at all were left out.")
    assert text_by_count[5] == text_by_count[4].replace("; 1 with none at all were left out", "")
