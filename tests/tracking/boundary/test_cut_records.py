"""Ratios of ellipses of cut records, against the closed form that each record has by itself."""

import numpy as np
import pytest

from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure
from reliab.tracking.boundary.finite_errors import ratios_of_cut_record
from reliab.tracking.boundary.first_order import exact_response, first_order_ellipse

STEP = 0.01


@pytest.mark.parametrize(("f", "xi", "share"), [(1.0, 0.05, 1.0), (2.0, 0.02, 0.5), (0.5, 0.1, 1.0)])
def test_ratio_is_that_of_the_ellipses_of_both_records(f, xi, share):
    """The ellipse of the first seconds as a record of its own, from its spectrum, over that of the whole."""
    rng = np.random.default_rng(4)
    t = np.arange(0.0, 40.0, STEP)
    record = rng.normal(size=t.size) * np.exp(-(((t - 12.0) / 6.0) ** 2))
    structure = Structure(frequency=f, damping_ratio=xi, experimental_fraction=share)
    whole, cut = (
        first_order_ellipse(Excitation(acceleration=part, time_step=STEP), structure)
        for part in (record, record[: round(20.0 / STEP) + 1])
    )
    response = exact_response(record, STEP, structure)
    (ratios,) = ratios_of_cut_record(response, STEP, structure, 0.0, (20.0,))
    assert ratios == pytest.approx([cut.amplitude / whole.amplitude, cut.delay / whole.delay], rel=0.01)


def test_quiet_time_before_the_onset_is_cut_first():
    quiet, structure = 20.0, Structure(frequency=1.0, damping_ratio=0.05)
    t = np.arange(0.0, 20.0, STEP)
    shaking = np.sin(7.0 * t) * np.exp(-(((t - 6.0) / 3.0) ** 2))
    late = np.concatenate([np.zeros(round(quiet / STEP)), shaking])
    (ratios,) = ratios_of_cut_record(
        exact_response(late, STEP, structure), STEP, structure, quiet, (20.0 - STEP,)
    )
    assert ratios == pytest.approx([0.5, 0.5], rel=0.01)  # nothing but half of the length is lost
