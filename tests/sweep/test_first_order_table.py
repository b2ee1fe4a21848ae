"""Ellipses predicted from spectra are those of simulation where errors are small, and say so where not."""

import numpy as np
import pytest

import reliab
from reliab.core.errors import InputError
from reliab.tracking.boundary.curves import Curve


@pytest.fixture(scope="module")
def motions():
    return reliab.load_motions("synthetic")[:4]


def test_small_errors_have_the_traced_ellipse_and_large_ones_a_larger_one(motions):
    request = {"f": [1.0], "xi": [0.05], "threshold": [0.001, 0.05]}
    boundary, prediction = reliab.ellipses(motions, **request), reliab.ellipses(
        motions, **request, first_order=True
    )  # fmt: skip
    for name in ("a", "b"):
        ratio = (boundary[name] / prediction[name]).squeeze()
        np.testing.assert_allclose(ratio.sel(threshold=0.001), 1.0, atol=0.06)
        assert (ratio.sel(threshold=0.05, side="lag") < 1.0).all()
    assert set(prediction.dims) == set(boundary.dims)


@pytest.mark.slow
def test_a_criterion_from_predicted_ellipses_repeats_their_caution(motions, tmp_path):
    from reliab.sweep.ellipse_dataset import open_ellipses, write_ellipses

    write_ellipses(reliab.ellipses(motions, first_order=True), tmp_path / "predicted.nc")
    result = reliab.derive_criterion(open_ellipses(tmp_path / "predicted.nc"))
    assert any("too generous" in warning for warning in result.provenance.warnings)


class Line(Curve):
    name = "line"


@pytest.mark.parametrize("wrong", [{"metric": ["mte"]}, {"curves": [Line]}])
def test_closed_form_refuses_unsupported_options(motions, wrong):
    with pytest.raises(InputError, match="closed form"):
        reliab.ellipses(motions, first_order=True, **wrong)


def test_stored_results_have_no_spectra(motions, tmp_path):
    results = reliab.simulate(motions[:1], out=tmp_path / "results.zarr")
    with pytest.raises(InputError, match="needs ground motions"):
        reliab.ellipses(results, first_order=True)
