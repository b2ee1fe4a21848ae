"""Frames: matrices, modes, damping and what is refused."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.structures.frame import Frame, exact_step, modal_damping, rayleigh_damping, square_matrix
from reliab.structures.planar_frame import PlanarFrame, shear_frame

REFERENCE_STIFFNESS = np.array(
    [
        [26054883.879603837, -23133938.877108198, 5937035.463339146],
        [-23133938.877108198, 32560774.186380334, -14419970.777236981],
        [5937035.463339146, -14419970.777236981, 9267275.506224312],
    ]
)


def test_benchmark_stiffness_follows_from_six_numbers():
    frame = PlanarFrame(
        storeys=3,
        bays=2,
        elastic_modulus=200e9,
        column_inertia=2.52 * 0.0254**4,
        beam_inertia=255267e-12,
        storey_height=0.635,
        bay_width=0.762,
    )
    np.testing.assert_allclose(frame.lateral_stiffness(), REFERENCE_STIFFNESS, rtol=1e-10)


def test_planar_frame_with_rigid_beams_is_a_shear_frame_and_a_fixed_base_is_four_times_stiffer():
    rigid = {
        "storeys": 2,
        "bays": 1,
        "elastic_modulus": 2e11,
        "column_inertia": 1e-6,
        "beam_inertia": 1e6,
    }
    pinned_frame = PlanarFrame(**rigid, storey_height=3.0, bay_width=6.0).lateral_stiffness()
    fixed = PlanarFrame(**rigid, storey_height=3.0, bay_width=6.0, fixed_base=True).lateral_stiffness()
    column = 2e11 * 1e-6 / 27.0
    np.testing.assert_allclose(fixed, shear_frame([1, 1], [24 * column, 24 * column])[1], rtol=1e-6)
    np.testing.assert_allclose(pinned_frame, shear_frame([1, 1], [6 * column, 24 * column])[1], rtol=1e-6)


@pytest.mark.parametrize(
    ("field", "value", "rule"),
    [
        ("elastic_modulus", 1e-320, "elastic modulus must be between 1 and"),
        ("storey_height", 1e150, "length of a column must be between"),
        ("storey_height", 1e-150, "length of a column must be between"),
        ("bay_width", 1e250, "length of a beam must be between"),
        ("beam_inertia", 0.0, "second moment of area of a beam must be between"),
        ("storeys", 10_000, "displacements and rotations at most"),
    ],
)
def test_unsolvable_planar_frame_is_refused(field, value, rule):
    frame = {
        "storeys": 2,
        "bays": 1,
        "elastic_modulus": 2e11,
        "column_inertia": 1e-6,
        "beam_inertia": 1e-6,
        "storey_height": 3.0,
        "bay_width": 6.0,
    }
    with pytest.raises(InputError, match=rule):
        PlanarFrame(**{**frame, field: value})


def test_one_storey_is_a_frame():
    mass, stiffness = shear_frame([2.0], [8.0])
    assert (mass.tolist(), stiffness.tolist()) == ([[2.0]], [[8.0]])


def test_damping_ratios_come_back():
    mass, stiffness = shear_frame([2000.0, 1500.0, 1000.0], [3e6, 2e6, 1e6])
    ratios = [0.01, 0.03, 0.05]
    frame = Frame(mass=mass, stiffness=stiffness, damping=modal_damping(mass, stiffness, ratios))
    np.testing.assert_allclose(frame.damping_ratios, ratios, rtol=1e-10)
    f = frame.modes.frequency
    frame = Frame(
        mass=mass,
        stiffness=stiffness,
        damping=rayleigh_damping(mass, stiffness, (0.02, 0.04), (f[0], f[2])),
    )
    np.testing.assert_allclose(frame.damping_ratios[[0, 2]], [0.02, 0.04], rtol=1e-10)


def test_negative_rayleigh_damping_is_refused():
    """At 1 and 2 rad/s with ζ and 4ζ: ζ(ω) = ½(a₀/ω + a₁ω) falls below zero only under 0.76 rad/s."""
    ratios, frequencies = (0.01, 0.04), (1.0 / (2.0 * np.pi), 2.0 / (2.0 * np.pi))
    mass_factor, stiffness_factor = np.linalg.solve(0.5 * np.array([[1.0, 1.0], [0.5, 2.0]]), ratios)
    limit = np.sqrt(-mass_factor / stiffness_factor)
    for omega in (1.01 * limit, 3.0):
        damping = rayleigh_damping([[2.0]], [[2.0 * omega**2]], ratios, frequencies)
        assert damping[0, 0] == pytest.approx(2.0 * (mass_factor + stiffness_factor * omega**2))
    with pytest.raises(InputError, match="every mode a positive damping ratio"):
        rayleigh_damping([[2.0]], [[2.0 * (0.99 * limit) ** 2]], ratios, frequencies)


def test_poles_are_those_of_the_modes():
    mass, stiffness = shear_frame([2.0, 1.0], [300.0, 100.0])
    frame = Frame(mass=mass, stiffness=stiffness, damping=modal_damping(mass, stiffness, 0.05))
    omega = frame.modes.circular_frequency
    np.testing.assert_allclose(frame.poles, omega * complex(-0.05, np.sqrt(1 - 0.05**2)), rtol=1e-9)


@pytest.mark.parametrize(
    ("variant", "sentence"),
    [
        ({"stiffness": [[2.0, -1.0], [-1.5, 1.0]]}, "stiffness matrix must be symmetric"),
        ({"stiffness": [[1.0, -1.0], [-1.0, 1.0]]}, "stiffness matrix must be positive definite"),
        ({"mass": [[1.0, 0.0], [0.0, 0.0]]}, "mass matrix must be positive definite"),
        ({"mass": [[1.0, 0.0], [0.0, -1.0]]}, "mass matrix must be positive definite"),
        ({"damping": [[-1.0, 0.0], [0.0, 0.0]]}, "must not have a negative eigenvalue"),
        ({"damping": [[np.nan, 0.0], [0.0, 0.0]]}, "largest entry of the damping matrix .* found nan"),
        ({"mass": [[1.0]]}, "must be of the same size"),
        ({"mass": [[1.0, 0.0]]}, "must be square"),
        ({"influence": [0.0, 0.0]}, "influence vector"),
        ({"names": ("roof", "roof")}, "different names"),
    ],
)
def test_bad_matrices_are_refused(variant, sentence):
    sound = {"mass": np.eye(2), "damping": np.zeros((2, 2)), "stiffness": [[2.0, -1.0], [-1.0, 1.0]]}
    with pytest.raises(InputError, match=sentence):
        Frame(**(sound | variant))


def test_an_unknown_degree_of_freedom_is_refused_with_those_there_are():
    mass, stiffness = shear_frame([1.0, 1.0], [2.0, 1.0])
    frame = Frame(mass=mass, stiffness=stiffness, damping=np.zeros((2, 2)), names=("first", "roof"))
    with pytest.raises(InputError, match="Name one of first, roof"):
        frame.degree_of_freedom("cellar")
    assert frame.degree_of_freedom("roof") == 1


@pytest.mark.parametrize(
    "build",
    [
        lambda: modal_damping(np.eye(2), np.eye(2), [0.1, 0.2, 0.3]),
        lambda: modal_damping(np.eye(1), np.eye(1), 2.0),
        lambda: rayleigh_damping(np.eye(1), np.eye(1), (0.1, 0.1), (1.0, 1.0)),
        lambda: rayleigh_damping(np.diag([1.0, 1.0]), np.diag([1.0, 1e6]), (0.01, 0.2), (1.0, 2.0)),
        lambda: shear_frame([1.0], [1.0, 2.0]),
        lambda: shear_frame([1.0], [-1.0]),
        lambda: shear_frame([], []),
    ],
)
def test_bad_damping_and_storeys_are_refused(build):
    with pytest.raises(InputError):
        build()


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
def test_symmetry_is_judged_by_the_matrix_s_own_size(unit):
    stiffness = unit * np.array([[2.0, -1.0], [-1.0 + 1e-7, 1.0]])
    np.testing.assert_array_equal(square_matrix(stiffness, "matrix"), (stiffness + stiffness.T) / 2.0)
    with pytest.raises(InputError, match="must be symmetric"):
        square_matrix(stiffness + unit * np.array([[0.0, 1e-5], [0.0, 0.0]]), "matrix")


def test_several_loads_have_the_effects_of_each_alone():
    dynamics, loads = np.array([[0.0, 1.0], [-9.0, -0.3]]), np.array([[0.0, 1.0, 2.0], [1.0, 0.0, -3.0]])
    joint = exact_step(dynamics, loads, 0.1)
    separate = [exact_step(dynamics, load[:, np.newaxis], 0.1) for load in loads.T]
    for place in (1, 2):
        np.testing.assert_allclose(joint[place], np.hstack([item[place] for item in separate]), rtol=1e-12)
