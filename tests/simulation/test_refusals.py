"""What no compensator, rig, transfer system or frame can be is refused, by its own rule."""

import math
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
import scipy
from reliab_studies.laboratory.compensators.adaptive_inverse import AdaptiveInverse
from reliab_studies.laboratory.compensators.adaptive_model_based import AdaptiveModelBased
from reliab_studies.laboratory.compensators.adaptive_time_series import AdaptiveTimeSeries
from reliab_studies.laboratory.compensators.low_pass import butterworth_sections
from reliab_studies.laboratory.compensators.pi_phase_lead import PhaseLeadControl
from reliab_studies.laboratory.laboratory import Limits, Rig, Sensors, run_laboratory

from reliab.core.errors import InputError
from reliab.simulation.frames.frame_file import frame_of_tables
from reliab.simulation.frames.transfer_table import read_matlab, transfer_function_of
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.simulation.hybrid_test.open_loop import Motion3, load
from reliab.simulation.transfer_systems.transfer_function import ServoHydraulic, TransferFunction
from reliab.structures.frame import Specimen
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

STEP = 1.0 / 1024.0
PARTITION = Partition.from_structure(Structure(frequency=1.0, damping_ratio=0.05), mass=1000.0)
SERIES = partial(AdaptiveTimeSeries, factors=(1.0, 0.02, 0.0002))
MODEL_BASED = partial(AdaptiveModelBased, factors=(1.0, 0.02, 8.4e-5, 2e-7))
MODEL = partial(
    UpdatedModel, name="model", test=HybridTest(structure=Structure(frequency=1.0, damping_ratio=0.05))
)
NO_SPECIMEN = HybridTest(structure=None, specimen=None)
STILL = Motion3.interpolate(np.zeros(64), STEP)

LAG = TransferFunction(numerator=(1.0,), denominator=(0.001, 1.0))


def laboratory(rig, **options):
    return run_laboratory(PARTITION, rig, np.zeros(64), 0.01, **options)


@pytest.mark.parametrize(
    ("make", "rule"),
    [
        (lambda: AdaptiveInverse(steps=0.5), "at least one step; found 0.5"),
        (lambda: AdaptiveInverse(steps=math.inf), "at least one step; found inf"),
        (lambda: AdaptiveInverse(steps=4.0, proportional=-1.0), "The proportional gain .* found -1.0"),
        (lambda: AdaptiveInverse(steps=4.0, integral=math.nan), "The integral gain .* found nan"),
        (lambda: MODEL_BASED(factors=(1.0, 0.02, 8.4e-5)), "four finite factors and four rates"),
        (lambda: MODEL_BASED(factors=(1.0, 0.02, 8.4e-5, math.inf)), "four finite factors"),
        (lambda: MODEL_BASED(rates=(1.0, 1.0, 1.0, -1.0)), "four finite factors and four rates"),
        (lambda: SERIES(lowest=(0.7, 0.0)), "three finite numbers each"),
        (lambda: SERIES(fastest=(2.0, math.nan, 0.001)), "three finite numbers each"),
        (lambda: SERIES(lowest=(1.4, 0.0, 0.0)), "lower bound of a factor must not exceed the upper one"),
        (lambda: SERIES(samples=0), "must be positive; found 0, 1.0 s, 0.00025 m"),
        (lambda: SERIES(window=0.0), "must be positive; found 16, 0.0 s"),
        (lambda: SERIES(trigger=0.0), "must be positive; found 16, 1.0 s, 0.0 m"),
        (lambda: SERIES(window=0.03).coefficients(STEP), "hold 3 to .* of its samples; found 2"),
        (lambda: SERIES(samples=1, window=60.0).coefficients(STEP), "hold 3 to .* found 61440"),
        (lambda: butterworth_sections(4, 0.0, STEP), "positive and below half .* found 0.0 Hz at 1024 Hz"),
        (lambda: butterworth_sections(4, 512.0, STEP), "positive and below half of the sampling rate"),
        (lambda: PhaseLeadControl(quantum=-1e-6), "controller's quantum must be finite and not negative"),
        (lambda: PhaseLeadControl(lead=math.inf), "controller's lead must be finite and not negative"),
        (lambda: MODEL(deviations={"gain": -0.1}), "gain.* standard deviation must be 0 or positive"),
        (lambda: MODEL(deviations={"delay_s": math.inf}), "delay_s.* standard deviation must be finite"),
        (lambda: load(NO_SPECIMEN, STILL), "A force needs a specimen"),
        (lambda: Sensors(force_noise=-1.0), "force noise of a sensor must be finite and not negative"),
        (lambda: Sensors(displacement_step=math.inf), "displacement step of a sensor must be finite"),
        (lambda: Limits(stroke=0.0), "limit of the rig's stroke must be positive"),
        (lambda: Limits(force=math.nan), "limit of the rig's force must be positive"),
        (lambda: laboratory(Rig(sensors=Sensors(displacement_noise=1e-6))), "noise need a seed"),
        (lambda: laboratory(Rig(sensors=Sensors(force_noise=1.0))), "noise need a seed"),
        (
            lambda: laboratory(Rig(transfer_system=LAG), emulate_differences=True),
            "servo-hydraulic actuator and a linear specimen with mass; found TransferFunction",
        ),
        (
            lambda: laboratory(Rig(transfer_system=LAG, limits=Limits(force=1.0))),
            "A force is limited where the transfer system has one",
        ),
        (
            lambda: ServoHydraulic().plant(Specimen(stiffness=1e6, damping=1.0)),
            "with damping needs a moving mass",
        ),
        (lambda: ServoHydraulic().plant(Specimen(stiffness=0.0)), "needs a stiffness to hold the actuator"),
        (
            lambda: transfer_function_of(
                scipy.signal.StateSpace([[-1.0]], [[1.0, 1.0]], [[1.0]], [[0.0, 0.0]])
            ),
            "one input and one output; found 2 and 1",
        ),
        (
            lambda: transfer_function_of(SimpleNamespace(num=[[[1.0], [2.0]]], den=[[[1.0, 1.0]]])),
            "one input and one output; found 2 channels",
        ),
    ],
)
def test_each_rule_refuses_its_violation(make, rule):
    with pytest.raises(InputError, match=rule):
        make()


@pytest.mark.parametrize(
    ("content", "rule"),
    [
        ({"num": np.array(["a"], dtype=object), "den": [1.0, 1.0]}, "a full matrix of numbers"),
        ({"num": [math.nan], "den": [1.0, 1.0]}, "finite"),
        ({"num": [1.0], "den": [1.0, 1.0j]}, "real numbers"),
        ({"A": [[-1e200]], "B": [[1e200]], "C": [[1e200]], "D": [[0.0]]}, "are too large"),
    ],
)
def test_variables_of_a_matlab_file_are_numbers_of_their_kind(tmp_path, content, rule):
    scipy.io.savemat(tmp_path / "plant.mat", content)
    with pytest.raises(InputError, match=rule):
        read_matlab(tmp_path / "plant.mat")


def test_frame_with_unbounded_numbers_is_refused():
    tables = {
        "frame": {"masses_kg": [2e3, 2e3], "storey_stiffnesses_n_per_m": [1.5e308, 1.5e308]},
        "damping": {"ratio": 0.03},
        "specimen": {"degree_of_freedom": "1", "stiffness_n_per_m": 1e300},
    }
    with pytest.raises(InputError, match=r"frame.toml.*stiffness must be between"):
        frame_of_tables(tables, "frame.toml")
