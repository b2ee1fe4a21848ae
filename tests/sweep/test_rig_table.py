"""The error of a described rig under many motions."""

import pytest

from reliab.core.errors import InputError
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.simulation.frames.frame_file import frame_of_tables
from reliab.sweep.frame_table import FrameRequest, errors_of_rig, summary_of_rig, trace_frame_ellipses
from reliab.tracking.indices.window import Window

TABLES = {
    "frame": {"masses_kg": [2000.0, 1500.0], "storey_stiffnesses_n_per_m": [4e5, 3e5]},
    "damping": {"ratio": 0.03},
    "specimen": {"degree_of_freedom": "1", "stiffness_n_per_m": 2e5},
}


@pytest.fixture(scope="module")
def motions():
    return synthetic_suite(count=2)


def frame(**transfer):
    return frame_of_tables({**TABLES, "transfer_system": transfer} if transfer else TABLES, "frame.toml")


@pytest.mark.slow
def test_a_rig_on_the_boundary_of_a_motion_has_the_error_of_the_boundary(motions):
    ellipses = trace_frame_ellipses(motions, FrameRequest(frame=frame()))
    b = ellipses["b"].sel(curve="ellipse", side="lag", threshold=0.05, metric="rms").squeeze()
    for place, motion in enumerate(motions):
        delay = float(b[place]) ** 0.5
        errors = errors_of_rig(frame(gain=1.0, delay_ms=delay), [motion], window=Window())
        assert errors["rms"][0] == pytest.approx(0.05, rel=0.1)  # the ellipse is fitted to the boundary
        assert errors["d_ms"][0] == pytest.approx(delay, rel=0.02)
        assert errors["A"][0] == pytest.approx(1.0, abs=0.01)


def test_the_summary_counts_motions_below_the_threshold(motions):
    errors = errors_of_rig(frame(gain=0.98, delay_ms=1.0), motions, window=Window())
    between = float(errors["rms"].mean())
    summary = summary_of_rig(errors, "rms", between)
    assert summary["stable"]
    assert summary["share_below"] == 0.5
    assert summary["largest"] == pytest.approx(errors["rms"].max())
    assert [motion["motion"] for motion in summary["motions"]] == [motion.name for motion in motions]


def test_an_unstable_rig_has_no_error(motions):
    errors = errors_of_rig(frame(gain=1.0, delay_ms=80.0), motions, window=Window())
    summary = summary_of_rig(errors, "rms", 0.05)
    assert summary["stable"] is False
    assert summary["largest"] is None
    assert summary["motions"] == []


def test_a_frame_without_a_rig_is_refused(motions):
    with pytest.raises(InputError, match="transfer system"):
        errors_of_rig(frame(), motions, window=Window())
