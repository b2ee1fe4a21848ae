"""Integration schemes of laboratories against the exact response, their orders and their stability."""

import numpy as np
import pytest
from reliab_studies.laboratory.integrators import CentralDifference, ChenRicles, OperatorSplitting

from reliab.simulation.excitation import Excitation
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.linear_loop import spectral
from reliab.structures.structure import Structure


def scheme(name, structure):
    schemes = {
        "cr": ChenRicles(structure=structure),
        "cd": CentralDifference(),
        "os": OperatorSplitting(structure=structure),
    }
    return schemes[name]


def record(step, duration=20.0):
    t = np.arange(0.0, duration + step / 2, step)
    return np.sin(2 * np.pi * 0.8 * t) * np.exp(-(((t - 6.0) / 3.0) ** 2))


def response(name, structure, step):
    test = HybridTest(structure=structure)
    return run_closed_loop(test, record(step), step, integrator=scheme(name, structure)).command.values[0]


@pytest.mark.parametrize("name", ["cr", "cd", "os"])
@pytest.mark.parametrize("fraction", [1.0, 0.4])
def test_scheme_converges_to_the_exact_response_with_second_order(name, fraction):
    structure = Structure(frequency=1.0, damping_ratio=0.05, experimental_fraction=fraction)
    errors = []
    for step in (0.01, 0.005):
        excitation = Excitation(acceleration=record(0.0025), time_step=0.0025)
        exact, fine = spectral.response(excitation, structure, 1.0, 0.0)
        solution = response(name, structure, step)
        samples = np.interp(step * np.arange(solution.size), fine * np.arange(exact.size), exact)
        errors.append(np.abs(solution - samples).max() / np.abs(exact).max())
    assert errors[1] < 2e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.15)


@pytest.mark.parametrize(("name", "stable"), [("cr", True), ("cd", False), ("os", True)])
def test_stability_at_a_step_of_a_third_of_the_period(name, stable):
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    solution = response(name, structure, 1.0 / 3.0)
    assert bool(np.isfinite(solution).all() and np.abs(solution).max() < 1.0) is stable


def test_schemes_agree_at_the_rate_of_a_laboratory():
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    cr, cd, splitting = (response(name, structure, 1.0 / 1024.0) for name in ("cr", "cd", "os"))
    assert np.abs(cr - cd).max() < 1e-4 * np.abs(cr).max()
    assert np.abs(cr - splitting).max() < 1e-4 * np.abs(cr).max()


def least_damped_pole(structure, step, delay, integrator):
    """Pole ln(z)/h of a test integrated in steps: largest eigenvalue z of its linear map from step to step.

    The state is displacement, velocity, acceleration, and the displacements that are still on their way.
    """
    w0, xi, h = structure.circular_frequency, structure.damping_ratio, step
    damping, specimen = 2.0 * xi * w0, structure.experimental_fraction * w0**2
    whole_steps = int(delay / step)
    part = delay / step - whole_steps
    (x, v, a), past = np.split(
        np.eye(whole_steps + 6), [3]
    )  # columns of the map are the images of unit vectors
    if integrator is ChenRicles:
        factor = 4.0 / (4.0 + 2.0 * h * damping + (h * w0) ** 2) * a
        x, v = x + h * v + h**2 * factor, v + h * factor
    else:
        x, v = x + h * v + 0.5 * h**2 * a, v + 0.5 * h * a
    sent = np.vstack([x, past])
    force = specimen * ((1.0 - part) * sent[whole_steps] + part * sent[whole_steps + 1])
    load = damping * v + (w0**2 - specimen) * x + force
    if integrator is ChenRicles:
        a = -load
    else:
        a = -load / (1.0 + 0.5 * h * damping)
        v = v + 0.5 * h * a
    poles = np.log(np.linalg.eigvals(np.vstack([x, v, a, sent[:-1]])).astype(complex) + 1e-300) / h
    return poles[np.argmax(poles.real)]


@pytest.mark.parametrize("integrator", [CentralDifference, ChenRicles])
def test_the_least_damped_discrete_pole_is_the_growth_of_the_integrated_test(integrator):
    structure = Structure(frequency=2.0, damping_ratio=0.02)
    step, delay = 1 / 256, 3.4 / 256
    pole = least_damped_pole(structure, step, delay, integrator)
    test = HybridTest(structure=structure, actuator=Actuator(delay=delay))
    scheme_of_test = integrator() if integrator is CentralDifference else integrator(structure=structure)
    ground = np.concatenate([np.hanning(30), np.zeros(1500)])
    displacement = run_closed_loop(test, ground, step, integrator=scheme_of_test).command.values[0]
    first, second = (
        np.std(displacement[part]) for part in (slice(500, 756), slice(1244, 1500))
    )  # two cycles each
    assert np.log(second / first) / (744 * step) == pytest.approx(pole.real, rel=0.02)
