"""Transfer systems: against the facts of the benchmark, SciPy, and files of other programs."""

import numpy as np
import pytest
from scipy import signal
from scipy.io import savemat

from reliab.core.errors import InputError
from reliab.simulation.frames.transfer_table import read_matlab, transfer_function_of
from reliab.simulation.transfer_systems.transfer_function import (
    ServoHydraulic,
    TransferFunction,
    gain_and_delay,
)
from reliab.structures.frame import Specimen

SPRING = Specimen(stiffness=1e6)
LAG = TransferFunction(numerator=(1.0,), denominator=(0.01, 1.0))
SECOND_ORDER = TransferFunction(numerator=(5685.0,), denominator=(1.0, 105.6, 5685.0))  # 12 Hz, 0.7


def state_space_transfer(plant, s):
    """Transfer function from the command to the displacement of a plant's state-space model."""
    order = plant.dynamics.shape[0]
    rational = [
        plant.displacement @ np.linalg.solve(position * np.eye(order) - plant.dynamics, plant.command)
        for position in s
    ]
    return (np.array(rational) + plant.displacement_of_command) * np.exp(-s * plant.delay)


def test_benchmark_plant_has_the_published_gains_and_delays(benchmark_partition):
    f = np.array([0.5, 2, 3.17, 3.44, 5, 8, 16, 38])
    response = ServoHydraulic().transfer(2j * np.pi * f, benchmark_partition(1).specimen)
    np.testing.assert_allclose(
        np.abs(response), [1.0055, 0.9762, 0.9342, 0.9228, 0.8509, 0.7117, 0.4708, 0.2741], atol=6e-5
    )
    np.testing.assert_allclose(
        -np.unwrap(np.angle(response)) / (2e-3 * np.pi * f),
        [25.05, 24.63, 24.01, 23.84, 22.74, 20.43, 15.75, 11.09],
        atol=6e-3,
    )


def test_benchmark_plant_has_the_published_poles(benchmark_partition):
    specimen = benchmark_partition(1).specimen
    poles = np.linalg.eigvals(ServoHydraulic().plant(specimen).dynamics)
    expected = [-8.00 + 421.8j, -8.00 - 421.8j, -184.0 + 229.9j, -184.0 - 229.9j, -48.2]
    for pole in expected:
        assert np.abs(poles - pole).min() < 0.06


@pytest.mark.parametrize(
    ("system", "specimen"),
    [
        (ServoHydraulic(), Specimen(stiffness=1.19e6, damping=114.0, mass=29.0)),
        (ServoHydraulic(), SPRING),
        (TransferFunction(numerator=(0.98,), denominator=(0.004, 1.0), delay=0.001), SPRING),
        (SECOND_ORDER, Specimen(stiffness=1e5, damping=10.0, mass=4.0)),
        (TransferFunction(numerator=[2.0, 300.0], denominator=[1e-4, 0.1, 20.0, 300.0]), SPRING),
        (gain_and_delay(0.97, 0.003), SPRING),
    ],
)
def test_state_space_and_transfer_function_agree(system, specimen):
    s = 2j * np.pi * np.array([0.1, 1.0, 7.0, 40.0])
    np.testing.assert_allclose(
        state_space_transfer(system.plant(specimen), s), system.transfer(s, specimen), rtol=1e-8
    )


def test_force_row_is_the_specimens_force():
    specimen, system = Specimen(stiffness=1e5, damping=30.0, mass=4.0), SECOND_ORDER
    plant, s = system.plant(specimen), 20j
    states = np.linalg.solve(s * np.eye(2) - plant.dynamics, plant.command.astype(complex))
    force = plant.force @ states + plant.force_of_command
    impedance = specimen.stiffness + s * (specimen.damping + s * specimen.mass)
    assert force == pytest.approx(impedance * system.transfer(np.array([s]), specimen)[0], rel=1e-9)


class ControlTransferFunction:
    """What python-control's TransferFunction looks like: channels in two lists, poles by a method."""

    def __init__(self, num=(3.0,), dt=0, channels=1):
        self.num = [[np.array(num)] * channels]
        self.den = [[np.array([0.01, 1.0])] * channels]
        self.dt = dt

    def poles(self):
        return np.array([-100.0])

    def zeros(self):
        return np.array([])


class ControlStateSpace:
    """What python-control's StateSpace looks like."""

    A, B, C, D, dt = np.array([[-100.0]]), np.array([[300.0]]), np.array([[1.0]]), np.zeros((1, 1)), 0


@pytest.mark.parametrize(
    "model",
    [
        signal.TransferFunction([3.0], [0.01, 1.0]),
        signal.ZerosPolesGain([], [-100.0], 300.0),
        signal.StateSpace(-100.0, 300.0, 1.0, 0.0),
        ControlTransferFunction(),
        ControlTransferFunction(dt=None),
        ControlStateSpace(),
    ],
)
def test_models_of_other_libraries_are_read(model):
    result = transfer_function_of(model)
    s = 1j * np.array([1.0, 100.0])
    np.testing.assert_allclose(result.transfer(s, SPRING), 3.0 / (0.01 * s + 1.0), rtol=1e-12)


@pytest.mark.parametrize(
    ("content", "variable"),
    [
        ({"num": [3.0], "den": [0.01, 1.0]}, None),
        ({"servo": {"num": [3.0], "den": [0.01, 1.0]}}, "servo"),
        ({"z": np.zeros(0), "p": [-100.0], "k": 300.0}, None),
        ({"A": [[-100.0]], "B": [[300.0]], "C": [[1.0]], "D": [[0.0]]}, None),
    ],
)
def test_matlab_files_are_read(tmp_path, content, variable):
    savemat(tmp_path / "model.mat", content)
    result = read_matlab(tmp_path / "model.mat", variable, delay=0.001)
    assert result.delay == 0.001
    assert abs(result.transfer(np.array([100j]), SPRING)[0]) == pytest.approx(3.0 / np.sqrt(2.0))


def test_other_matlab_files_are_refused(tmp_path):
    savemat(tmp_path / "model.mat", {"something": 1.0})
    with pytest.raises(InputError, match="num and den"):
        read_matlab(tmp_path / "model.mat")
    with pytest.raises(InputError, match="It holds something"):
        read_matlab(tmp_path / "model.mat", "servo")
    two_inputs = {"A": -np.eye(2), "B": np.eye(2), "C": [[1.0, 0.0]], "D": [[0.0, 0.0]]}
    savemat(tmp_path / "model.mat", two_inputs)
    with pytest.raises(InputError, match="one input and one output"):
        read_matlab(tmp_path / "model.mat")
    (tmp_path / "text.mat").write_text("no matrix")
    with pytest.raises(InputError, match="must be readable"):
        read_matlab(tmp_path / "text.mat")
    with pytest.raises(InputError, match=r"absent\.mat: No such file"):
        read_matlab(tmp_path / "absent.mat")


@pytest.mark.parametrize(
    ("build", "sentence"),
    [
        (lambda: TransferFunction(numerator=[1.0], denominator=[1.0, -3.0]), "must be stable"),
        (lambda: TransferFunction(numerator=[1.0], denominator=[1.0, 0.0, 0.0]), "repeated poles"),
        (
            lambda: TransferFunction(numerator=[1.0], denominator=np.poly([2j, -2j, 2j, -2j]).real),
            "repeated poles",
        ),
        (lambda: TransferFunction(numerator=[1.0, 0.0, 0.0], denominator=[1.0, 1.0]), "higher order"),
        (lambda: TransferFunction(numerator=[0.0], denominator=[1.0]), "not all zero"),
        (lambda: TransferFunction(numerator=[1.0], denominator=[np.nan, 1.0]), "finite"),
        (lambda: gain_and_delay(1.0, -0.001), "must not be negative"),
        (lambda: TransferFunction.from_poles([], [-1 + 1j], 1.0), "conjugate pairs"),
        (lambda: transfer_function_of(signal.TransferFunction([1.0], [1.0, 0.5], dt=0.1)), "continuous time"),
        (lambda: transfer_function_of(ControlTransferFunction(dt=0.1)), "discrete time, dt = 0.1"),
        (lambda: transfer_function_of(ControlTransferFunction(dt=True)), "discrete time, dt = True"),
        (lambda: transfer_function_of(ControlTransferFunction(channels=2)), "one input and one output"),
        (lambda: transfer_function_of("servo"), "scipy.signal or python-control"),
        (
            lambda: LAG.plant(Specimen(stiffness=1.0, mass=1.0)),
            "more poles than zeros",
        ),
        (lambda: ServoHydraulic(leakage=-1.0), "must be positive"),
        (lambda: ServoHydraulic().plant(Specimen(stiffness=0.0)), "needs a stiffness"),
    ],
)
def test_bad_transfer_systems_are_refused(build, sentence):
    with pytest.raises(InputError, match=sentence):
        build()


def test_a_single_undamped_pair_of_poles_is_allowed():
    undamped_frame = TransferFunction(numerator=[100.0], denominator=[1.0, 0.0, 100.0])
    assert sorted(undamped_frame.poles.imag) == pytest.approx([-10.0, 10.0])


def test_a_single_integrator_is_allowed():
    integrator = TransferFunction(numerator=[1.0], denominator=[1.0, 0.0])
    assert integrator.denominator == (1.0, 0.0)


@pytest.mark.parametrize("gain", [0.0, -1.0, np.inf, -np.inf, np.nan])
def test_missing_gain_is_refused(gain):
    with pytest.raises(InputError, match="positive and finite"):
        gain_and_delay(gain)
