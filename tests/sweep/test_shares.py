"""Results and ellipses of several shares of the stiffness are those of each share, side by side."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from reliab.core.errors import InputError
from reliab.core.vocabulary import LABELS, Metric, Side
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.frame_file import FrameUnderTest
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure
from reliab.sweep.ellipse_table import EllipseRequest, predict_ellipses, trace_ellipses
from reliab.sweep.frame_table import FrameRequest, trace_frame_ellipses
from reliab.sweep.grid import ScaledGrid
from reliab.sweep.request import SweepRequest
from reliab.sweep.results import open_results, write_compact
from reliab.sweep.run import run_sweep
from reliab.sweep.shares import at_share, shares_of
from reliab.tracking.boundary.curves import Ellipse, InscribedEllipse
from reliab.tracking.indices.response_error import relative_error

SHARES = (0.25, 1.0)
REQUEST = SweepRequest(
    frequencies=(1.0,),
    damping_ratios=(0.02, 0.05),
    experimental_fractions=SHARES,
    grid=ScaledGrid(gain_steps=8, delay_steps=10, lead_steps=8),
)


@pytest.fixture(scope="module")
def two(suite):
    return suite[:2]


@pytest.fixture(scope="module")
def results(tmp_path_factory, two):
    return open_results(run_sweep(two, REQUEST, tmp_path_factory.mktemp("shares") / "results.zarr"))


def test_the_share_is_a_dimension_after_the_damping_ratio(results):
    assert results["rms"].dims == ("motion", "f", "xi", "alpha", "kp", "tau")
    assert results["rms_at_rest"].dims == ("motion", "f", "xi", "alpha")
    assert results["alpha"].attrs["long_name"] == LABELS["alpha"].long_name
    assert shares_of(results) == SHARES
    assert "experimental_fraction" not in results.attrs


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("share", SHARES)
def test_each_share_has_the_bits_of_its_own_sweep(tmp_path, two, results, share):
    alone = replace(REQUEST, experimental_fractions=(share,))
    own = open_results(run_sweep(two, alone, tmp_path / "results.zarr"))
    part = at_share(results, share)
    assert shares_of(own) == (share,)
    xr.testing.assert_equal(part, own)
    xr.testing.assert_equal(at_share(results.reliab.ellipses(), share), own.reliab.ellipses())


def test_a_request_of_one_share_is_known_by_the_digest_that_stores_already_carry():
    described = replace(REQUEST, experimental_fractions=(0.5,)).describe()
    assert described["experimental_fraction"] == 0.5
    assert "experimental_fractions" not in described


def test_cells_of_a_share_hold_what_the_delay_equation_gives(results, two):
    motion = two[0]
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    part = at_share(results, 0.25)
    structure = part.reliab.structure(1.0, 0.05)
    assert structure.experimental_fraction == 0.25
    cells = REQUEST.grid.cells(structure)
    some = np.flatnonzero((cells.delay > 0.0) & cells.stable)[::11]
    chosen = replace(cells, gain=cells.gain[some], delay=cells.delay[some])
    exact = relative_error(
        Loop(excitation=excitation, structure=structure, engine=Engine.DELAY).deviation(chosen), Metric.RMS
    )
    stored = part["rms"].sel(f=1.0, xi=0.05).isel(motion=0).values.ravel()[some]
    np.testing.assert_allclose(stored, exact, rtol=2e-3, atol=1e-5)


def test_small_errors_have_the_ellipse_of_the_closed_form(two):
    request = EllipseRequest(
        frequencies=(1.0,),
        damping_ratios=(0.05,),
        experimental_fractions=(0.3, 1.0),
        thresholds=(0.002,),
        curves=(Ellipse,),
    )
    traced, predicted = trace_ellipses(two, request), predict_ellipses(two, request)
    assert traced["a"].dims == predicted["a"].dims == ("motion", "f", "xi", "alpha", *traced["a"].dims[4:])
    np.testing.assert_allclose(traced["a"], predicted["a"], rtol=0.03)
    np.testing.assert_allclose(traced["b"].sel(side="lag"), predicted["b"].sel(side="lag"), rtol=0.06)


def test_compact_files_keep_the_dimension(tmp_path, results):
    write_compact(results, tmp_path / "results.nc")
    opened = open_results(tmp_path / "results.nc")
    assert shares_of(opened) == SHARES
    np.testing.assert_allclose(opened["rms"], results["rms"].clip(max=1.0), rtol=3e-4, atol=1e-5)


def test_what_is_asked_of_one_share_is_refused_for_several(results):
    with pytest.raises(InputError, match="one share"):
        results.reliab.structure(1.0, 0.02)
    with pytest.raises(InputError, match="has no such share"):
        at_share(results, 0.5)
    chosen = results.sel(alpha=0.25)  # by xarray's own means, which leaves a coordinate
    assert chosen.reliab.structure(1.0, 0.02).experimental_fraction == 0.25


@pytest.mark.parametrize("shares", [(), (0.5, 0.5), (1.0, 0.5)])
def test_shares_that_do_not_increase_are_refused(shares):
    with pytest.raises(InputError, match="increase"):
        replace(REQUEST, experimental_fractions=shares)


def traced_frame(motions, request, **options):
    structure = Structure(frequency=1.0, damping_ratio=0.05)
    frame = FrameUnderTest(
        name="frame",
        partition=Partition.of_structure(structure, mass=20.0),
        output=None,
        error_of="interface",
    )
    asked = {name: getattr(request, name) for name in ("thresholds", "metrics", "curves", "sides")}
    return trace_frame_ellipses(motions, FrameRequest(frame=frame, **asked), **options)


TABLE = EllipseRequest(
    frequencies=(0.5, 1.0),
    damping_ratios=(0.02, 0.05),
    thresholds=(0.02, 0.05),
    curves=(InscribedEllipse, Ellipse),
)
ALONE = replace(  # the second f, curve and metric, but the first ξ, side and threshold
    TABLE,
    frequencies=(1.0,),
    damping_ratios=(0.02,),
    thresholds=(0.02,),
    curves=(Ellipse,),
    sides=(Side.LAG,),
)
BOTH = (Metric.MTE, Metric.RMS)


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    ("trace", "metrics"), [(trace_ellipses, BOTH), (traced_frame, BOTH), (predict_ellipses, (Metric.RMS,))]
)
def test_an_entry_of_a_table_is_what_is_traced_for_it_alone(two, trace, metrics):
    """Structures, thresholds, metrics, curves and sides stand where the labels say."""
    whole = trace(two, replace(TABLE, metrics=metrics))
    one = trace(two[1:], ALONE)
    for name in ("a", "b", "n", "no_ellipse"):
        part = whole[name].sel({dimension: one[dimension].values for dimension in one[name].dims})
        np.testing.assert_allclose(part.values, one[name].values, rtol=1e-4)


@pytest.mark.parametrize("trace", [trace_ellipses, traced_frame, predict_ellipses])
def test_progress_rises_to_its_total(two, trace):
    steps = []
    request = replace(ALONE, experimental_fractions=SHARES)
    trace(two, request, progress=lambda *step: steps.append(step))
    done, totals = zip(*steps, strict=True)
    assert list(done) == sorted(set(done))
    assert set(totals) == {done[-1]}
