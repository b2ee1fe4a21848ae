"""What no error of a test can be computed from is refused, by its own rule."""

import numpy as np
import pytest

from reliab.assessment.modelled_test import tangent_structure
from reliab.assessment.monitor import Monitor
from reliab.assessment.rebuilt_error.readings import delay_history
from reliab.core.errors import InputError
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.structures.frame import Specimen
from reliab.structures.structure import Structure

STRUCTURE = Structure(frequency=1.0, damping_ratio=0.05)


@pytest.mark.parametrize(
    ("make", "rule"),
    [
        (lambda: delay_history(np.ones(8), -0.1, 1.0), "finite and not negative; found -0.1 s"),
        (lambda: delay_history(np.ones(8), np.inf, 1.0), "finite and not negative; found inf s"),
        (lambda: delay_history(np.ones(8), 4.5, 0.5), "must be shorter than the test; found 4.5 s"),
        (lambda: Monitor(STRUCTURE, 0.0), "time step must be between .* found 0 s"),
        (lambda: Monitor(STRUCTURE, np.inf), "time step must be between .* found inf s"),
        (
            lambda: tangent_structure(HybridTest(structure=None, specimen=Specimen(stiffness=1.0))),
            "needs a numerical substructure",
        ),
    ],
)
def test_impossible_input_is_refused_by_its_own_rule(make, rule):
    with pytest.raises(InputError, match=rule):
        make()


def test_prompt_force_is_fed_back_unchanged():
    values = np.arange(8.0)
    assert delay_history(values, 0.0, 1.0) is values


@pytest.mark.parametrize("mass", [1.0, 50.0])
def test_the_tangent_structure_is_per_unit_mass_with_the_specimen_inside(mass):
    """Numerical and experimental parts add up to the whole, whatever its mass is."""
    full_test = Structure(frequency=2.0, damping_ratio=0.05, experimental_fraction=0.25)
    specimen = Specimen(stiffness=3.0 * mass, damping=0.2 * mass, mass=0.1 * mass)
    result = tangent_structure(HybridTest(structure=full_test, mass=mass, specimen=specimen))
    omega = 2.0 * np.pi * 2.0
    assert result.mass == pytest.approx(np.array([[1.1]]))
    assert result.stiffness == pytest.approx(np.array([[0.75 * omega**2 + 3.0]]))
    assert result.damping == pytest.approx(np.array([[2.0 * 0.05 * omega + 0.2]]))
    coverage = (result.specimen_stiffness, result.specimen_damping, result.specimen_mass)
    assert coverage == pytest.approx((3.0, 0.2, 0.1))
