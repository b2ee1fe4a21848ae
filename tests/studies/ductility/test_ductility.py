"""Tolerances with nonlinear specimens: the linear limit, an independent integration, and their summaries."""

import numpy as np
import pandas as pd
import pytest
from reliab_studies.ductility.specimens import NonlinearSpecimen, SpecimenKind
from reliab_studies.ductility.tolerances import DIRECTIONS, compare_levels, compare_limits, tolerances
from reliab_studies.ductility.yielding import _fine, _response

from reliab.core.errors import InputError
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure
from reliab.tracking.boundary.suite_boundary import motion_contours

STRUCTURE = Structure(frequency=1.0, damping_ratio=0.05)
THRESHOLD = 0.05


@pytest.fixture(scope="module")
def motion():
    return synthetic_suite(count=3)[1]


def tolerances_at_level(motion, kind, level):
    specimen = NonlinearSpecimen(kind=SpecimenKind(kind), level=level)
    return tolerances([motion], [STRUCTURE], [specimen], threshold=THRESHOLD).iloc[0]


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(("kind", "level"), [("bilinear", 0.4), ("coulomb", 1e-6), ("cubic", 1e-6)])
def test_a_nearly_linear_specimen_tolerates_as_much_as_a_linear_one(motion, kind, level):
    row = tolerances_at_level(motion, kind, level)
    np.testing.assert_allclose(row[list(DIRECTIONS)].astype(float), 1.0, rtol=2e-3)


def test_linear_tolerances_lie_on_the_boundary_of_another_engine(motion):
    row = tolerances_at_level(motion, "cubic", 1e-6)
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    (contour,) = motion_contours(Loop(excitation=excitation, structure=STRUCTURE), (THRESHOLD,))
    punctual = np.interp(1.0, contour.amplitude, contour.delay)
    assert row["linear_delay_ms"] == pytest.approx(1e3 * punctual, rel=5e-3)
    assert 1.0 + row["linear_large"] == pytest.approx(contour.amplitude.max(), abs=1e-3)
    assert 1.0 - row["linear_small"] == pytest.approx(contour.amplitude.min(), abs=1e-3)


@pytest.mark.parametrize("direction", ["late", "large"])
def test_a_yielding_test_at_its_tolerance_has_the_tolerated_error_in_an_independent_integration(
    motion, direction
):
    row = tolerances_at_level(motion, "bilinear", 3.0)
    record, step = _fine(motion, STRUCTURE)
    linear = _response(record, step, STRUCTURE, 1.0, 0.0, np.inf)
    limit = float(np.abs(linear).max()) / 3.0
    exact = _response(record, step, STRUCTURE, 1.0, 0.0, limit)
    gain = 1.0 + (row["linear_large"] * row["large"] if direction == "large" else 0.0)
    delay = 1e-3 * row["linear_delay_ms"] * row["late"] if direction == "late" else 0.0
    test = _response(record, step, STRUCTURE, gain, delay, limit)
    error = np.sqrt(np.mean((test - exact) ** 2)) / np.abs(exact).max()
    assert error == pytest.approx(THRESHOLD, rel=0.05)
    assert row["ductility"] == pytest.approx(np.abs(exact).max() / limit, rel=0.02)


def test_a_level_without_meaning_is_refused():
    with pytest.raises(InputError, match="must be positive"):
        NonlinearSpecimen(kind=SpecimenKind.COULOMB, level=-0.1)
    with pytest.raises(InputError, match="different from zero"):
        NonlinearSpecimen(kind=SpecimenKind.CUBIC, level=0.0)


def make_tests(count):
    """Tests of a specimen whose tolerances are known: narrower by a tenth in every fifth test."""
    names = [f"m{number}" for number in range(count)]
    late = np.where(np.arange(count) % 5 == 0, 0.9, 2.0)
    return pd.DataFrame(
        {
            "motion": names,
            "event": names,
            "f": 1.0,
            "xi": 0.02,
            "specimen": "bilinear",
            "level": 2.0,
            "ductility": 3.0,
            "linear_delay_ms": np.linspace(1.0, 2.0, count),
            "linear_large": 0.01,
            "linear_small": 0.012,
            **dict.fromkeys(DIRECTIONS, 1.5),
            "late": late,
        }
    )


def test_levels_count_tests_of_smaller_tolerance():
    rows = compare_levels(make_tests(40))
    overall = rows[rows["f"].isna()].set_index("direction")
    assert overall.loc["late", "narrower"] == overall.loc["narrowest", "narrower"] == pytest.approx(0.2)
    assert overall.loc["large", "narrower"] == 0.0
    assert overall.loc["late", "low"] < 0.2 < overall.loc["late", "high"]
    assert overall.loc["narrowest", "q50"] == pytest.approx(1.5)
    assert set(rows["f"].dropna()) == {1.0}


def test_limits_are_kept_by_95_percent_of_the_motions():
    tests = make_tests(40)
    (row,) = compare_limits(tests).to_dict(orient="records")
    delays = np.sort(tests["linear_delay_ms"] * tests["late"])
    assert row["delay_ms"] == pytest.approx(np.quantile(delays, 0.05))
    assert row["amplitude"] == pytest.approx(0.015)
    assert row["linear_amplitude"] == pytest.approx(0.01)


def test_few_motions_state_no_limit():
    assert compare_limits(make_tests(19))["delay_ms"].isna().all()


def test_a_diverging_response_is_counted_and_tolerates_nothing():
    tests = make_tests(40)
    tests.loc[:9, list(DIRECTIONS)] = np.nan
    overall = compare_levels(tests).query("f != f").set_index("direction")
    assert overall.loc["late", "lost"] == 10
    assert overall.loc["late", "tests"] == 30
    assert compare_limits(tests)["delay_ms"].item() == 0.0
