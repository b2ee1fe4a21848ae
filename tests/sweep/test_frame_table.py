"""Tables of ellipses of frames and rigs."""

import dataclasses

import numpy as np
import pytest

from reliab import load_motions
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.simulation.frames.frame_file import FrameUnderTest, frame_of_tables, governing_mode
from reliab.structures.frame import Frame, Specimen, floor_interface
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure
from reliab.sweep.ellipse_table import EllipseRequest, trace_ellipses
from reliab.sweep.frame_table import FrameRequest, errors_of_rig, summary_of_rig, trace_frame_ellipses
from reliab.tracking.indices.window import Window


def frame_under_test(partition, output=None):
    return FrameUnderTest(name="frame", partition=partition, output=output, error_of="interface")


def test_a_frame_of_one_mass_has_the_ellipses_of_the_one_mode_structure():
    motions = load_motions("synthetic")[:1]
    structure = Structure(frequency=1.0, damping_ratio=0.05)
    frame = frame_under_test(Partition.from_structure(structure, mass=20.0))
    options = {"thresholds": (0.03, 0.05), "metrics": (Metric.RMS, Metric.MTE)}
    result = trace_frame_ellipses(motions, FrameRequest(frame=frame, **options))
    expected = trace_ellipses(motions, EllipseRequest(frequencies=(1.0,), damping_ratios=(0.05,), **options))
    expected = expected.drop_dims("length")  # how a frame's records can be cut is not known
    assert result.sizes == expected.sizes
    for name in ("a", "b", "error_at_rest"):
        np.testing.assert_allclose(result[name].values, expected[name].values, rtol=5e-3)
    assert result.attrs["experimental_fraction"] == pytest.approx(1.0)


def test_the_governing_mode_is_described_as_it_is():
    structure = Structure(frequency=1.7, damping_ratio=0.03, experimental_fraction=0.4)
    mode = governing_mode(Partition.from_structure(structure, mass=3.0))
    assert dataclasses.astuple(mode) == pytest.approx((1.7, 0.03, 0.4))


def test_specimen_tolerating_no_delay_has_no_boundary():
    frame = Frame.from_structure(Structure(frequency=1.0, damping_ratio=0.02), mass=100.0)
    heavy = Partition.from_frame(
        frame=frame, interface=floor_interface(frame, 1), specimen=Specimen(stiffness=100.0, mass=60.0)
    )
    with pytest.raises(InputError, match="unstable without any delay"):
        FrameRequest(frame=frame_under_test(heavy))


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
    event_variance = float(errors["rms"].mean())
    summary = summary_of_rig(errors, "rms", event_variance)
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
