"""Fitted laws, over any grid."""

import json

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.criterion.laws.law import scales, validate_grid
from reliab.criterion.laws.registry import FITTED_LAWS, law_from_dict, law_to_dict
from reliab.criterion.laws.table import TabulatedLimits

F = np.array([0.25, 0.5, 1.0, 2.0])
XI = np.array([0.02, 0.05, 0.1])
EACH_LAW = pytest.mark.parametrize("law", FITTED_LAWS.values(), ids=FITTED_LAWS)

SHAPES = {
    "table": lambda f, xi: (0.2 * xi**2 * f**0.3, 3.0 * (xi / f) ** 2),
    "dimensionless": lambda f, xi: tuple(
        each * np.exp(0.3 * np.log(f) ** 2 - 0.2 * np.log(f) * np.log(xi)) for each in scales(f, xi)
    ),
    "power": lambda f, xi: (0.1 * f**0.2 * xi**1.7, 2.0 * f**-2.1 * xi**1.5),
    "exponential": lambda f, xi: (0.02 * xi + 0.0 * f, 500.0 * xi * np.exp(-3.0 * f)),
}


def grid(law):
    return SHAPES[law.name](F[:, None], XI[None, :])


@EACH_LAW
def test_its_own_shape_is_reproduced(law):
    fit = law.fit(F, XI, *grid(law))
    for result, given_limit in zip(fit.limits(F[:, None], XI[None, :]), grid(law), strict=True):
        np.testing.assert_allclose(result, given_limit, rtol=1e-8)


@EACH_LAW
def test_limits_are_positive_and_finite_between_the_structures(law):
    fit = law.fit(F, XI, *grid(law))
    for limits in fit.limits(np.linspace(0.25, 2.0, 20)[:, None], np.linspace(0.02, 0.1, 15)[None, :]):
        assert limits.shape == (20, 15)
        assert (np.isfinite(limits) & (limits > 0.0)).all()


@EACH_LAW
def test_a_factor_on_the_limits_passes_through_the_fit(law):
    a, b = grid(law)
    for once, scaled_copy in zip(
        law.fit(F, XI, a, b).limits(1.3, 0.03),
        law.fit(F, XI, 0.7 * a, 0.7 * b).limits(1.3, 0.03),
        strict=True,
    ):
        assert float(scaled_copy) == pytest.approx(0.7 * float(once))


@EACH_LAW
def test_use_outside_of_the_grid_is_refused(law):
    fit = law.fit(F, XI, *grid(law))
    for structure in ((0.2, 0.05), (2.1, 0.05), (1.0, 0.01), (1.0, 0.11)):
        with pytest.raises(InputError, match="does not hold for this"):
            fit.limits(*structure)


@EACH_LAW
def test_a_law_comes_back_from_json(law):
    fit = law.fit(F, XI, *grid(law))
    assert law_from_dict(json.loads(json.dumps(law_to_dict(fit)))) == fit


@EACH_LAW
def test_one_structure_is_enough(law):
    fit = law.fit([1.0], [0.02], [[5.3e-5]], [[1.04]])
    assert [float(limit) for limit in fit.limits(1.0, 0.02)] == pytest.approx([5.3e-5, 1.04])


def test_an_unknown_law_is_refused():
    with pytest.raises(InputError, match="Unknown law"):
        law_from_dict({"name": "magic"})


def test_a_table_keeps_a_limit_of_zero():
    table = TabulatedLimits.fit([1.0, 2.0], [0.02], [[0.0], [1e-4]], [[0.0], [1.0]])
    a, _ = table.limits([1.0, 1.5, 2.0], 0.02)
    assert a.tolist() == [0.0, 0.0, pytest.approx(1e-4)]


@pytest.mark.parametrize(
    "law", [law for law in FITTED_LAWS.values() if law is not TabulatedLimits], ids=lambda law: law.name
)
@pytest.mark.parametrize("place", [0, 1])
def test_a_law_with_logarithms_refuses_a_limit_of_zero(law, place):
    limits = list(map(np.copy, grid(law)))
    limits[place][1, 2] = 0.0
    with pytest.raises(
        InputError, match="which no law of f and ξ can follow; found limits of zero at 1 structures"
    ):
        law.fit(F, XI, *limits)


@pytest.mark.parametrize(
    "wrong", [[0.0, 1.0], [-1.0, 1.0], [1.0, 1.0], [2.0, 1.0], [1.0, np.inf], [np.nan], [], [[1.0, 2.0]]]
)
def test_other_grids_are_refused(wrong):
    with pytest.raises(InputError, match=r"positive, finite, at most 1e\+30, and increasing"):
        validate_grid("frequencies", wrong)


@pytest.mark.parametrize("grid", [[0.25], [0.25, 0.5, 2.0]])
def test_a_grid_is_kept(grid):
    assert validate_grid("frequencies", grid).tolist() == grid
