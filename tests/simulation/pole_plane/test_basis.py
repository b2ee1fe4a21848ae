"""The expansion of a moved pole, against the definition of its functions."""

import numpy as np
import pytest

from reliab.simulation.linear_loop.pole_plane import FARTHEST, distance, pole_basis
from reliab.structures.structure import Structure

STRUCTURES = [
    Structure(frequency=1.0, damping_ratio=0.02),
    Structure(frequency=2.0, damping_ratio=0.1, experimental_fraction=0.6),
    Structure(frequency=0.25, damping_ratio=0.05),
]


def takenaka_malmquist(poles, s):
    """Functions φ_k at s, by their definition; shape (poles, frequencies)."""
    filters = (s + poles[:, np.newaxis].conj()) / (s - poles[:, np.newaxis])
    before = np.cumprod(np.concatenate([np.ones((1, s.size)), filters[:-1]]), axis=0)
    return before / (s - poles[:, np.newaxis])


@pytest.mark.parametrize("structure", STRUCTURES)
def test_share_left_out_is_the_same_at_every_frequency(structure):
    basis = pole_basis(structure)
    scale = structure.damping_ratio * structure.circular_frequency
    moved = structure.pole + scale * np.array([0.3, 0.2j, -0.5 + 0.4j, -0.9j])
    s = 1j * structure.circular_frequency * np.linspace(-5.0, 5.0, 201)
    coefficients, left_out = basis.coefficients(moved)
    rest = 1.0 / (s - moved[:, np.newaxis]) - coefficients.T @ takenaka_malmquist(basis.poles, s)
    share = np.abs(rest * (s - moved[:, np.newaxis]))
    np.testing.assert_allclose(share, np.tile(left_out[:, np.newaxis], s.size), rtol=1e-6, atol=1e-12)
    assert left_out.max() < 1e-3


@pytest.mark.parametrize("structure", STRUCTURES)
def test_functions_are_sums_of_the_responses_of_single_poles(structure):
    basis = pole_basis(structure)
    s = 1j * structure.circular_frequency * np.linspace(-3.0, 3.0, 61)
    count = basis.poles.size
    fractions = basis.orthogonal[:count, :count] + 1j * basis.orthogonal[count:, :count]
    functions = fractions @ (1.0 / (s - basis.poles[:, np.newaxis]))
    defined = takenaka_malmquist(basis.poles, s)
    np.testing.assert_allclose(functions, defined, atol=1e-6 * np.abs(defined).max())


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
