"""The plane of gains and delays: basis and quadratic forms against the simulated loop."""

from dataclasses import replace

import numpy as np
import pytest

from reliab.motions.loading import load_motions
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop.pole_plane import FARTHEST, distance, mean_squares, pole_basis
from reliab.structures.structure import Structure

STRUCTURES = [
    Structure(frequency=1.0, damping_ratio=0.02),
    Structure(frequency=2.0, damping_ratio=0.1, experimental_fraction=0.6),
    Structure(frequency=0.25, damping_ratio=0.05),
]


def takenaka_malmquist(poles, s):
    """Functions φ_k at s, by their definition; shape (poles, frequencies)."""
    filters = (s + poles[:, np.newaxis].conj()) / (s - poles[:, np.newaxis])
    first = np.cumprod(np.concatenate([np.ones((1, s.size)), filters[:-1]]), axis=0)
    return first / (s - poles[:, np.newaxis])


@pytest.mark.parametrize("structure", STRUCTURES)
def test_share_left_out_is_the_same_at_every_frequency(structure):
    basis = pole_basis(structure)
    scale = structure.damping_ratio * structure.circular_frequency
    displacement = structure.pole + scale * np.array([0.3, 0.2j, -0.5 + 0.4j, -0.9j])
    s = 1j * structure.circular_frequency * np.linspace(-5.0, 5.0, 201)
    coefficients, left_out = basis.coefficients(displacement)
    remainder = 1.0 / (s - displacement[:, np.newaxis]) - coefficients.T @ takenaka_malmquist(basis.poles, s)
    share = np.abs(remainder * (s - displacement[:, np.newaxis]))
    np.testing.assert_allclose(share, np.tile(left_out[:, np.newaxis], s.size), rtol=1e-6, atol=1e-12)
    assert left_out.max() < 1e-3


@pytest.mark.parametrize("structure", STRUCTURES)
def test_functions_are_sums_of_the_responses_of_single_poles(structure):
    basis = pole_basis(structure)
    s = 1j * structure.circular_frequency * np.linspace(-3.0, 3.0, 61)
    count = basis.poles.size
    fractions = basis.orthogonal[:count, :count] + 1j * basis.orthogonal[count:, :count]
    functions = fractions @ (1.0 / (s - basis.poles[:, np.newaxis]))
    definition = takenaka_malmquist(basis.poles, s)
    np.testing.assert_allclose(functions, definition, atol=1e-6 * np.abs(definition).max())


def test_undisturbed_pole_is_expanded_exactly():
    structure = STRUCTURES[0]
    coefficients, left_out = pole_basis(structure).coefficients(np.array([structure.pole]))
    assert left_out[0] == 0.0
    assert coefficients[0, 0] == pytest.approx(1.0, rel=1e-14)
    assert not coefficients[1:].any()


def test_far_and_unstable_poles_are_not_expanded():
    structure = STRUCTURES[0]
    poles = np.array([-structure.pole.conjugate(), 1.2 * structure.pole, complex(np.nan, np.nan)])
    assert np.isinf(pole_basis(structure).coefficients(poles)[1]).all()
    assert (distance(poles, structure.pole) > FARTHEST).all()


TIME = np.arange(0.0, 30.0, 0.01)
HOSTILE = {
    "impulse": (np.abs(TIME - 3.0) < 0.005).astype(float),
    "harmonic at the structure's frequency": np.sin(2.0 * np.pi * TIME),
    "harmonic above it": np.sin(2.0 * np.pi * 9.0 * TIME),
    "step that stays": (TIME > 2.0).astype(float),
    "end in strong motion": np.random.default_rng(1).standard_normal(TIME.size) * TIME,
}


def actuators(loop: Loop, reach: float):
    """Late and early actuators whose errors scale with the damping ratio."""
    xi, w0 = loop.structure.damping_ratio, loop.structure.circular_frequency
    gain, delay = np.meshgrid(
        1.0 + reach * xi * np.linspace(-1, 1, 5), reach * xi / w0 * np.linspace(-1, 1, 7)
    )
    return loop.cells(gain=gain, delay=delay)


def plane(loop, cells):
    first = np.zeros(cells.gain.size, dtype=np.int64)
    return mean_squares([loop.responses], cells.expansions(loop.blocks.step), first)


def largest_difference(loop, cells, engine):
    """Largest difference of RMS^R where the plane answers, and the share that it answers."""
    squares, reference = plane(loop, cells)
    oracle = replace(loop, engine=engine).deviation(cells).mean_square
    displacement = reference & (oracle > 1e-12 * loop.blocks.ideal_peak**2)
    return np.abs(np.sqrt(squares[displacement] / oracle[displacement]) - 1.0).max(
        initial=0.0
    ), reference.mean()


@pytest.mark.parametrize("seed", range(8))
def test_plane_agrees_with_the_spectral_engine(random_excitation, seed):
    rng = np.random.default_rng(seed)
    excitation = random_excitation(rng)
    structure = Structure(
        frequency=float(rng.choice([0.25, 1.0, 2.0])),
        damping_ratio=float(rng.choice([0.02, 0.05, 0.1])),
        experimental_fraction=float(rng.choice([1.0, 0.6])),
    )
    loop = Loop(excitation=excitation, structure=structure)
    difference, share = largest_difference(loop, actuators(loop, 0.4), Engine.SPECTRAL)
    assert difference < 1e-4
    assert share > 0.9


@pytest.mark.parametrize("name", HOSTILE)
@pytest.mark.parametrize("window", [(0.0, -1.0), (1.5, 4.2)])
def test_plane_keeps_its_tolerance_on_hostile_records(name, window):
    excitation = Excitation(acceleration=HOSTILE[name], time_step=0.01, window=window)
    loop = Loop(excitation=excitation, structure=Structure(frequency=1.0, damping_ratio=0.03))
    difference, _ = largest_difference(loop, actuators(loop, 0.8), Engine.POLE)
    assert difference < 3e-5


def test_plane_agrees_on_the_real_records(real_motions_folder):
    rng = np.random.default_rng(16)
    motions = load_motions(real_motions_folder)
    for index in rng.integers(0, len(motions), 5):
        motion = motions[int(index)]
        structure = Structure(
            frequency=float(rng.choice([0.25, 0.5, 1.0, 2.0])), damping_ratio=float(rng.choice([0.02, 0.05]))
        )
        excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
        loop = Loop(excitation=excitation, structure=structure)
        difference, share = largest_difference(loop, actuators(loop, 0.4), Engine.POLE)
        assert difference < 3e-5
        assert share > 0.5


def test_imprecise_cells_are_not_answered():
    excitation = Excitation(acceleration=HOSTILE["impulse"], time_step=0.01)
    loop = Loop(excitation=excitation, structure=Structure(frequency=1.0, damping_ratio=0.02))
    cells = loop.cells(gain=[1.0, 1.0, 1.6], delay=[0.001, 0.02, 0.0])
    _, reference = plane(loop, cells)
    assert reference.tolist() == [True, False, False]
