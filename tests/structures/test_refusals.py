"""What no structure, specimen, partition or effect can be is refused, by its own rule."""

import math
from functools import partial

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.effects.effect import Parameter, Scales
from reliab.effects.registry import find_effect
from reliab.structures.frame import Specimen
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

SOUND = Structure(frequency=1.0, damping_ratio=0.05)
PARTITION = Partition.from_structure(SOUND, mass=10.0)
FRICTION = partial(find_effect("coulomb_friction"), regularisation_velocity_m_per_s=1e-3)
FORCE = FRICTION(force_n=1.0)
READING = find_effect("sensor_bias")(bias_m=0.001)
SCALES = {"displacement": 2.0, "velocity": 3.0, "acceleration": 5.0, "force": 7.0, "duration": 11.0}


def parameter(**variant):
    words = {"name": "force_n", "units": "N", "meaning": "a force", "starts": (1.0,)}
    return Parameter(**{**words, "lower": 0.1, "upper": 2.0, **variant})


def partition(**variant):
    parts = {"frame": PARTITION.frame, "interface": PARTITION.direction, "specimen": PARTITION.specimen}
    return Partition.from_frame(**{**parts, **variant})


@pytest.mark.parametrize(
    ("make", "rule"),
    [
        (lambda: Structure(frequency=0.0, damping_ratio=0.05), "between 0.01 and 10,000 Hz; found 0 Hz"),
        (
            lambda: Structure(frequency=math.inf, damping_ratio=0.05),
            "between 0.01 and 10,000 Hz; found inf Hz",
        ),
        (lambda: Structure(frequency=0.009, damping_ratio=0.05), "between 0.01 and 10,000 Hz; found 0.009"),
        (lambda: Structure(frequency=1.1e4, damping_ratio=0.05), "between 0.01 and 10,000 Hz; found 11,000"),
        (lambda: Structure(frequency=1.0, damping_ratio=1.0), "at least 1e-12 and below 1; found 1"),
        (lambda: Structure(frequency=1.0, damping_ratio=0.0), "at least 1e-12 and below 1; found 0"),
        (lambda: Structure(frequency=1.0, damping_ratio=1e-15), "damping ratio must be at least 1e-12"),
        (
            lambda: Structure(frequency=1.0, damping_ratio=0.05, experimental_fraction=1e-15),
            "share of the stiffness in the laboratory must be between 1e-06 and 1",
        ),
        (
            lambda: Structure(frequency=1.0, damping_ratio=0.05, experimental_fraction=0.0),
            "between 1e-06 and 1",
        ),
        (
            lambda: Structure(frequency=1.0, damping_ratio=0.05, experimental_fraction=1.1),
            "between 1e-06 and 1",
        ),
        (lambda: Specimen(stiffness=-1.0), "stiffness of the specimen must be 0, or between"),
        (
            lambda: Specimen(stiffness=1.0, mass=math.inf),
            "mass of the specimen must be 0, or between .* found inf kg",
        ),
        (
            lambda: Specimen(stiffness=1.0, damping=math.nan),
            "damping coefficient of the specimen must be .* found nan",
        ),
        (lambda: partition(interface=np.zeros(1)), "not all zero; found"),
        (lambda: partition(interface=np.ones(2)), "needs 1 finite numbers"),
        (lambda: partition(interface=np.array([math.nan])), "not all zero; found"),
        (lambda: partition(effects=(FORCE, READING)), "must act on its force; found sensor_bias"),
        (lambda: partition(specimen=Specimen(stiffness=0.0)), "neither stiffness nor damping nor mass"),
        (
            lambda: FRICTION(force_n=math.nan),
            "force_n of coulomb_friction must be finite",
        ),
        (
            lambda: find_effect("stroke_saturation")(stroke_m=0.0),
            "stroke_m of .* must be positive",
        ),
        (lambda: Scales(**{**SCALES, "duration": 0.0}), "scale of duration must be positive and finite"),
        (lambda: Scales(**{**SCALES, "force": math.inf}), "scale of force must be positive and finite"),
        (lambda: parameter(lower=2.0), "lower bound of force_n must be below the upper one; found 2.0 and 2"),
        (lambda: parameter(lower=0.0), "lower bound of force_n must be positive"),
    ],
)
def test_each_rule_refuses_its_violation(make, rule):
    with pytest.raises(InputError, match=rule):
        make()


def test_bounds_themselves_are_allowed():
    for frequency in (0.01, 1e4):
        assert Structure(frequency=frequency, damping_ratio=0.05, experimental_fraction=1.0)
    assert find_effect("sensor_bias")(bias_m=-0.001)
    assert parameter(lower=-1.0, signed=True)
    assert partition(effects=(FORCE,), specimen=Specimen(stiffness=0.0)).effects == (FORCE,)
