"""The posterior of a test: against the truth, against a sampler, and against its own prior."""

import math
from dataclasses import replace

import numpy as np
import pytest
from assessment.inference.simulated_loop import earthquake, play, simulate
from scipy.interpolate import CubicSpline

from reliab.assessment.budget.sizes import exact_equipment, ordinary_equipment
from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.evidence import ImpliedGroundMotion
from reliab.assessment.inference.posterior import infer
from reliab.assessment.inference.randomized_optimization import LeastSquares
from reliab.assessment.inference.rebuilt import rebuild
from reliab.assessment.inference.uncertain_quantity import Circumstances
from reliab.assessment.inferred_error import draw_errors
from reliab.assessment.rebuilt_error.error_statistics import relative_errors
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

STEP = 1.0 / 256.0


def circumstances_of(test, *, f, xi, share=1.0, ground=False, equipment=None, stated_values=None):
    partition = Partition.from_structure(
        Structure(frequency=f, damping_ratio=xi, experimental_fraction=share)
    )
    channels = ChannelSpectra.from_channels(
        test.command[np.newaxis],
        test.measured[np.newaxis],
        test.time_step,
        partition,
        ground=test.ground if ground else None,
    )
    return Circumstances(
        partition=partition,
        channels=channels,
        stated=stated_values or {},
        equipment=equipment or exact_equipment(),
    )


@pytest.fixture(scope="module")
def late_test():
    ground = earthquake(duration=30.0, time_step=STEP, seed=1)
    return simulate(
        frequency=1.0, damping_ratio=0.03, gain=0.99, delay=0.004, ground=ground, time_step=STEP, noise=0.002
    )


@pytest.mark.parametrize("ground", [False, True])
def test_rebuilt_error_is_exact_when_everything_is_known(late_test, ground):
    circumstances = circumstances_of(late_test, f=1.0, xi=0.03, ground=ground)
    posterior = infer(circumstances, draws=4)
    result = draw_errors(posterior).draws[0]
    assert result.estimate(Metric.RMS).value == pytest.approx(late_test.rms, rel=0.02)
    assert result.estimate(Metric.MTE).value == pytest.approx(late_test.mte, rel=0.03)


def test_ground_acceleration_shows_frequency_and_damping(late_test):
    stated_values = {"f": StatedValue(1.02, 0.02), "xi": StatedValue(0.025, 0.005)}
    circumstances = circumstances_of(late_test, f=1.02, xi=0.025, ground=True, stated_values=stated_values)
    posterior = infer(circumstances, draws=50)
    frequency = 1.02 * (1.0 + posterior.means["frequency"])
    ratio = 0.025 * (1.0 + posterior.means["damping_ratio"])
    assert frequency == pytest.approx(1.0, abs=5e-4)
    assert ratio == pytest.approx(0.03, rel=0.01)
    assert posterior.deviations["frequency"] < 0.05 * 0.02


def test_hysteresis_of_a_sensor_is_mistaken_for_nothing_else():
    """It swallows the small motions at a record's end, and makes the large ones before them late."""
    ground = earthquake(duration=30.0, time_step=STEP, seed=1)
    ground *= np.exp(-np.arange(ground.size) * STEP / 4.0) + 0.01
    loop = {"frequency": 3.0, "damping_ratio": 0.04, "gain": 0.99, "delay": 0.004}
    test = simulate(**loop, ground=ground, time_step=STEP)
    noise = 0.002 * test.measured.std() * np.random.default_rng(1).normal(size=test.measured.size)
    plain, played = (
        infer(
            circumstances_of(
                replace(test, measured=reading + noise), f=3.0, xi=0.04, equipment=ordinary_equipment()
            ),
            draws=100,
        )
        for reading in (test.measured, play(test.measured, 0.004))
    )
    assert played.means["hysteresis"] == pytest.approx(0.004, abs=2.0 * played.deviations["hysteresis"])
    for name in ("frequency", "time_shift", "damping_ratio"):
        assert played.means[name] == pytest.approx(plain.means[name], abs=0.3 * plain.deviations[name]), name


def _softening(*, seed, sensor, load_cell, gain, delay):
    """Posterior mean of a specimen's share whose stiffness is as stated, relative to it."""
    ground = earthquake(duration=30.0, time_step=STEP, seed=seed)
    loop = {"frequency": 3.8, "damping_ratio": 0.03, "share": 0.8, "gain": gain, "delay": delay}
    test = simulate(**loop, ground=ground, time_step=STEP, noise=sensor)
    noise = load_cell * test.force.std() * np.random.default_rng(seed).normal(size=test.force.size)
    structure = Structure(frequency=3.8, damping_ratio=0.03, experimental_fraction=0.8)
    partition = Partition.from_structure(structure)
    channels = ChannelSpectra.from_channels(
        test.command[np.newaxis],
        test.measured[np.newaxis],
        STEP,
        partition,
        ground=test.ground,
        force=(test.force + noise)[np.newaxis],
    )
    stated_values = {
        "f": StatedValue(3.8, 0.08),
        "alpha": StatedValue(0.8, 0.04),
        "mass": StatedValue(1.0, 0.02),
        "scale": StatedValue(1.0, 0.003),
    }
    posterior = infer(
        Circumstances(partition=partition, channels=channels, stated=stated_values, specimen_force=True),
        draws=16,
    )
    return posterior.means["experimental_fraction"]


@pytest.mark.parametrize(
    "channels",
    [
        {"sensor": 0.03, "load_cell": 0.0, "gain": 0.98, "delay": 0.0015},
        {"sensor": 0.001, "load_cell": 0.03, "gain": 1.002, "delay": 0.0003},
    ],
)
@pytest.mark.default_cases(1)
def test_noise_makes_no_specimen_softer(channels):
    """Errors in variables: a softer specimen, or a larger scale of the load cell, shrinks residuals."""
    softening = [_softening(seed=seed, **channels) for seed in range(4, 10)]
    # −0.04 and −0.02 if noise counts as softness; one test is 0.01 uncertain
    assert abs(np.mean(softening)) < 0.006


def test_recorded_excitation_never_widens_the_interval(late_test):
    widths = []
    for ground in (False, True):
        circumstances = circumstances_of(
            late_test, f=1.0, xi=0.03, ground=ground, equipment=ordinary_equipment()
        )
        estimate = draw_errors(infer(circumstances)).draws[0].estimate(Metric.RMS)
        widths.append(estimate.high - estimate.low)
        assert estimate.low < late_test.rms < estimate.high
    assert widths[1] < widths[0]


def test_wrong_damping_ratio_conflicts_with_the_record(late_test):
    circumstances = circumstances_of(late_test, f=1.0, xi=0.2, equipment=ordinary_equipment())
    posterior = infer(circumstances, draws=1)
    ratio = next(unknown for unknown in posterior.unknowns if unknown.name == "damping_ratio")
    assert abs(posterior.conflict(ratio)) > 3.0


@pytest.mark.parametrize("last_frequency", [0.8, 2.5])
def test_frequency_is_not_learned_from_a_harmonic_or_swept_test(last_frequency):
    time = np.arange(0.0, 40.0, STEP)
    phase = 0.8 * time + (last_frequency - 0.8) * time**2 / 80.0
    ground = np.sin(2.0 * np.pi * phase) * np.minimum(time / 5.0, 1.0)
    test = simulate(
        frequency=1.0, damping_ratio=0.03, delay=0.004, ground=ground, time_step=STEP, noise=0.002
    )
    posterior = infer(circumstances_of(test, f=1.0, xi=0.03, equipment=ordinary_equipment()), draws=1)
    assert posterior.evidence == ()


def test_frequency_is_learned_from_an_earthquake(late_test):
    posterior = infer(circumstances_of(late_test, f=1.0, xi=0.03, equipment=ordinary_equipment()), draws=1)
    assert isinstance(posterior.evidence[0], ImpliedGroundMotion)


@pytest.mark.slow
def test_draws_agree_with_a_sampler(late_test):
    emcee = pytest.importorskip("emcee")
    stated_values = {
        "f": StatedValue(1.01, 0.01),
        "xi": StatedValue(0.03, 0.006),
        "skew": StatedValue(0.0, 1.0),
    }
    circumstances = circumstances_of(late_test, f=1.01, xi=0.03, ground=True, stated_values=stated_values)
    still = replace(circumstances.channels, offset_size=np.zeros(1), drift_size=np.zeros(1))
    posterior = infer(replace(circumstances, channels=still), draws=800)
    size = len(posterior.unknowns)
    generator = np.random.default_rng(3)
    spread = np.linalg.cholesky(posterior.fit.covariance)
    start = posterior.fit.mode + generator.standard_normal((8 * size, size)) @ spread.T
    moves = [(emcee.moves.DEMove(), 0.8), (emcee.moves.DESnookerMove(), 0.2)]  # along a bent ridge
    sampler = emcee.EnsembleSampler(8 * size, size, posterior.fit.log_density, moves=moves)
    sampler.random_state = np.random.RandomState(3).get_state()
    sampler.run_mcmc(start, 6000)
    chain = sampler.get_chain(discard=2000, flat=True)
    weights = posterior.draws.weights
    mean = weights @ posterior.draws.values
    deviation = np.sqrt(weights @ (posterior.draws.values - mean) ** 2)
    np.testing.assert_allclose(mean, chain.mean(axis=0), atol=0.2 * chain.std(axis=0).max())
    np.testing.assert_allclose(deviation, chain.std(axis=0), rtol=0.2)
    assert posterior.draws.effective > 300


def _rank(seed):
    """Ranks of the truth among the draws, for a test that was drawn from the prior itself."""
    generator = np.random.default_rng(seed)
    z = generator.standard_normal(4)
    f, xi = 1.0 * np.exp(0.015 * z[0]), 0.03 * np.exp(0.15 * z[1])
    ground = earthquake(duration=25.0, time_step=STEP, seed=seed)
    test = simulate(
        frequency=f,
        damping_ratio=xi,
        gain=1.0 + 0.01 * generator.standard_normal(),
        delay=round(generator.uniform(0.0, 6.0)) * STEP / 8.0,
        ground=ground,
        time_step=STEP,
        noise=0.003,
        seed=seed,
    )
    time = np.arange(test.command.size) * STEP
    read = CubicSpline(time, test.measured)(time - 0.0005 * z[3]) * (1.0 + 0.003 * z[2])
    screen = {
        "f": StatedValue(1.0, 0.015),
        "xi": StatedValue(0.03, 0.15 * 0.03),
        "scale": StatedValue(1.0, 0.003),
        "skew": StatedValue(0.0, 0.5),
    }
    channels_test = type(test)(**{**vars(test), "measured": read})
    posterior = infer(
        circumstances_of(channels_test, f=1.0, xi=0.03, ground=bool(seed % 2), stated_values=screen),
        draws=100,
    )
    truths = {
        "frequency": f - 1.0,
        "damping_ratio": xi / 0.03 - 1.0,
        "sensor_scale": 0.003 * z[2],
        "time_shift": 0.0005 * z[3],
    }
    names = [unknown.name for unknown in posterior.unknowns]
    weights = posterior.draws.weights
    ranks = {
        name: float(weights @ (posterior.values[:, names.index(name)] < truth))
        for name, truth in truths.items()
    }
    ranks["error"] = float(weights @ (draw_errors(posterior).draws[0].rms < test.rms))
    return ranks


@pytest.mark.slow
def test_truths_drawn_from_the_prior_have_uniform_ranks():
    from scipy.stats import kstest

    ranks = [_rank(seed) for seed in range(80)]
    for name in ranks[0]:
        assert kstest([rank[name] for rank in ranks], "uniform").pvalue > 0.005, name


def test_rebuilt_response_of_the_mode_reproduces_the_exact_one(late_test):
    circumstances = circumstances_of(late_test, f=1.0, xi=0.03)
    posterior = infer(circumstances, draws=4)
    channels = circumstances.channels
    result = rebuild(channels, circumstances.partition, posterior.mode)
    exact = channels.band.history(result.exact)[0]
    true = np.interp(channels.band.time, np.arange(late_test.exact.size) * STEP, late_test.exact)
    residual, _ = relative_errors(exact - true, true)
    assert residual < 1e-3


def test_walkers_draw_where_no_approximation_holds(monkeypatch):
    """A parabola of two quantities, against sums over a grid."""
    monkeypatch.setattr("reliab.assessment.inference.randomized_optimization._FEWEST", np.inf)
    width = 0.3
    fit = LeastSquares(
        residuals=lambda z: np.array([(z[1] - 2.0 * z[0] ** 2) / width]),
        update=lambda _: None,
        determinant=lambda _: 0.0,
        start=np.full(2, 0.1),
        positive=np.zeros(2, dtype=bool),
    )
    fit.fit()
    draws = fit.draw(1024, seed=3)
    axis = np.linspace(-5.0, 5.0, 801)
    x, y = np.meshgrid(axis, axis)
    density = np.exp(-0.5 * (x**2 + y**2 + ((y - 2.0 * x**2) / width) ** 2))
    for place, values in enumerate((x, y)):
        mean = np.average(values, weights=density)
        deviation = np.sqrt(np.average((values - mean) ** 2, weights=density))
        assert np.mean(draws.values[:, place]) == pytest.approx(mean, abs=0.2 * deviation)
        assert np.std(draws.values[:, place]) == pytest.approx(deviation, rel=0.2)


@pytest.mark.parametrize("told", [-1.0, 0.3])
@pytest.mark.parametrize("enough", [0.5, np.inf])
def test_parameters_that_cannot_be_negative_stay_positive(monkeypatch, told, enough):
    """Two half-normal and one normal parameter, drawn at once and by steps, against sums over a grid."""
    monkeypatch.setattr("reliab.assessment.inference.randomized_optimization._ENOUGH", enough)
    deviation = 0.4
    rows = np.array([[1.0, 1.0, 1.0], [1.0, -0.5, 0.0]])
    fit = LeastSquares(
        residuals=lambda z: (rows @ z - told) / deviation,
        update=lambda _: None,
        determinant=lambda _: 0.0,
        start=np.zeros(3),
        positive=np.array([True, False, True]),
    )
    fit.fit()
    draws = fit.draw(4096, seed=3)
    axis, half = np.linspace(-5.0, 5.0, 101), np.linspace(0.0, 4.0, 161)
    worlds = np.stack(np.meshgrid(half, axis, half, indexing="ij"), axis=-1)
    density = np.exp(-0.5 * (((worlds @ rows.T - told) / deviation) ** 2).sum(-1) - 0.5 * (worlds**2).sum(-1))
    density[0], density[:, :, 0] = density[0] / 2.0, density[:, :, 0] / 2.0
    for place in range(3):
        mean = np.average(worlds[..., place], weights=density)
        spread = np.sqrt(np.average((worlds[..., place] - mean) ** 2, weights=density))
        drawn = draws.values[:, place]
        drawn_mean = draws.weights @ drawn
        assert drawn_mean == pytest.approx(mean, abs=0.05 * spread)
        assert np.sqrt(draws.weights @ (drawn - drawn_mean) ** 2) == pytest.approx(spread, rel=0.05)
    log_sum = np.log(density.sum() * (axis[1] - axis[0]) * (half[1] - half[0]) ** 2)
    log_likelihood = -0.5 * np.sum(fit.residuals(fit.mode) ** 2)
    assert log_likelihood + fit.log_volume + 1.5 * np.log(2.0 * np.pi) == pytest.approx(log_sum, abs=0.03)


@pytest.mark.parametrize("enough", [0.5, np.inf])
def test_parameter_pressed_against_zero_stays_there(monkeypatch, enough):
    """Beside zero the density falls by exp(−z/scale), of which the mean is the scale."""
    monkeypatch.setattr("reliab.assessment.inference.randomized_optimization._ENOUGH", enough)
    told, deviation = -60.0, 0.5
    fit = LeastSquares(
        residuals=lambda z: np.array([(z[0] - told) / deviation]),
        update=lambda _: None,
        determinant=lambda _: 0.0,
        start=np.ones(1),
        positive=np.ones(1, dtype=bool),
    )
    fit.fit()
    draws = fit.draw(256, seed=1)
    assert fit.mode == 0.0
    assert draws.weights @ draws.values[:, 0] == pytest.approx(deviation**2 / -told, rel=0.1)
    assert np.isfinite(fit.log_volume)


def test_worlds_without_finite_numbers_have_no_density():
    fit = LeastSquares(
        residuals=lambda z: np.array([math.expm1(z[0])]),
        update=lambda _: None,
        determinant=lambda z: float(np.log(z[0])),
        start=np.ones(1),
        positive=np.zeros(1, dtype=bool),
    )
    assert np.isfinite(fit.log_density(np.ones(1)))
    assert fit.log_density(np.full(1, 1e4)) == -np.inf
    assert fit.log_density(-np.ones(1)) == -np.inf
