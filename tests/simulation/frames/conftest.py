"""Frames and motions for the tests of partitions."""

import numpy as np
import pytest

from reliab.structures.frame import Frame, Specimen, floor_interface, modal_damping
from reliab.structures.partition import Partition
from reliab.structures.planar_frame import shear_frame


@pytest.fixture
def random_partition():
    def build(seed, size=3, *, mass=True):
        rng = np.random.default_rng(seed)
        masses, stiffnesses = rng.uniform(800, 2000, size), rng.uniform(2e5, 8e5, size)
        m, k = shear_frame(masses, stiffnesses)
        frame = Frame(mass=m, stiffness=k, damping=modal_damping(m, k, rng.uniform(0.03, 0.08, size)))
        floor = int(rng.integers(size))
        specimen = Specimen(
            stiffness=0.3 * stiffnesses[floor] * rng.uniform(0.3, 1.0) / (floor + 1),
            damping=float(rng.uniform(5, 20)) * mass,
            mass=float(rng.uniform(5, 60)) * mass,
        )
        return Partition.from_frame(
            frame=frame, interface=floor_interface(frame, floor + 1), specimen=specimen
        )

    return build


@pytest.fixture
def shaken():
    rng = np.random.default_rng(5)
    samples = rng.standard_normal(600).cumsum()
    samples -= np.linspace(samples[0], samples[-1], 600)
    return np.convolve(samples, np.hanning(9), mode="same") * np.hanning(600)
