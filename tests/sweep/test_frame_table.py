"""Ellipses of a partitioned frame."""

import dataclasses

import numpy as np
import pytest

from reliab import load_motions
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.simulation.frames.frame_file import FrameUnderTest
from reliab.simulation.frames.governing_mode import governing_mode
from reliab.structures.frames.frame import Frame
from reliab.structures.partition import Partition
from reliab.structures.specimen import Specimen, floor_interface
from reliab.structures.structure import Structure
from reliab.sweep.ellipse_table import EllipseRequest, trace_ellipses
from reliab.sweep.frame_table import FrameRequest, trace_frame_ellipses


def framed(partition, output=None):
    return FrameUnderTest(name="frame", partition=partition, output=output, error_of="interface")


def test_a_frame_of_one_mass_has_the_ellipses_of_the_one_mode_structure():
    motions = load_motions("synthetic")[:1]
    structure = Structure(frequency=1.0, damping_ratio=0.05)
    frame = framed(Partition.of_structure(structure, mass=20.0))
    asked = {"thresholds": (0.03, 0.05), "metrics": (Metric.RMS, Metric.MTE)}
    found = trace_frame_ellipses(motions, FrameRequest(frame=frame, **asked))
    expected = trace_ellipses(motions, EllipseRequest(frequencies=(1.0,), damping_ratios=(0.05,), **asked))
    expected = expected.drop_dims("length")  # how a frame's records can be cut is not known
    assert found.sizes == expected.sizes
    for name in ("a", "b", "error_at_rest"):
        np.testing.assert_allclose(found[name].values, expected[name].values, rtol=5e-3)
    assert found.attrs["experimental_fraction"] == pytest.approx(1.0)


def test_the_governing_mode_is_described_as_it_is():
    structure = Structure(frequency=1.7, damping_ratio=0.03, experimental_fraction=0.4)
    mode = governing_mode(Partition.of_structure(structure, mass=3.0))
    assert dataclasses.astuple(mode) == pytest.approx((1.7, 0.03, 0.4))


def test_a_specimen_that_tolerates_no_delay_has_no_boundary():
    frame = Frame.from_structure(Structure(frequency=1.0, damping_ratio=0.02), mass=100.0)
    heavy = Partition.of_frame(
        frame=frame, interface=floor_interface(frame, 1), specimen=Specimen(stiffness=100.0, mass=60.0)
    )
    with pytest.raises(InputError, match="tolerates some delay"):
        FrameRequest(frame=framed(heavy))
