"""The posterior of everything that is uncertain about a test, by randomised optimisation.

Parameters are standard normal a priori. With the whitened residuals r(z) of all evidence, the mode minimises
|r(z)|² + |z|² (Gauss–Newton). Draws follow "randomize-then-optimize" (Bardsley, Solonen, Haario and Laine
2014, SIAM Journal on Scientific Computing 36, A1895): with F(z) = (r(z), z), J its Jacobian at the mode and
J = QR, each draw solves Qᵀ F(z) = ξ for a standard normal ξ (about the value at the mode), and has the weight
exp(−½|F|² + ½|QᵀF|²) |det R|/|det QᵀJ(z)|, whose last factor is close to one and left out. One step of each
solution is Laplace's approximation, with the weight exp(−½|F|² + ½|ξ|²); it is enough where most draws count.
Parameters that cannot be negative are half-normal a priori. They are the last columns of J, so that one
after the other is drawn from a normal distribution that is cut off at zero; the share that is left of each
goes into the weight (Geweke 1991, Computing Science and Statistics 23, 571).
Where few draws of either count, more are made; where still few do, an ensemble of walkers draws
(Foreman-Mackey, Hogg, Lang and Goodman 2013, Publications of the Astronomical Society of the Pacific 125,
306).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.assessment.inference.sobol import normal_points
from reliab.core.arrays import Array

_STEP = 1e-2  # of a standard deviation a priori, for derivatives
_ITERATIONS = 30
_UPDATES = 4  # of the variances
_STEP_TOLERANCE = 0.02  # of a standard deviation a posteriori
_CHORDS = 12
_RESIDUAL_TOLERANCE = 0.05
_DIVERGENCE_LIMIT = 1e6  # standard deviations from its solution, where a draw diverges
_ENOUGH = 0.5  # of the draws, that must count for Laplace's approximation to do
_MORE = 4  # times more, where too few of these count
_FEWEST = 32.0  # effective draws, below which an approximation is not trusted
_WALKERS, _FEWEST_WALKERS = 2, 32  # pairs of walkers for each quantity
_WALKER_STEPS = 300  # steps of each walker, of which the first half is left out
_POINTS_OF_VOLUME = 64
_LONGEST = 3.0  # standard deviations a priori in one step


@dataclass(frozen=True, kw_only=True, eq=False)
class Draws:
    """Draws of a posterior."""

    values: Array  # z, shape (draws, d)
    weights: Array  # Of each, shape (draws,), sum one

    @property
    def effective(self) -> float:
        """Effective number of draws."""
        return float(1.0 / np.sum(self.weights**2))


@dataclass(kw_only=True, eq=False)
class LeastSquares:
    """Residuals of all evidence, whitened with variances that are estimated on the way to the mode."""

    residuals: Callable[[Array], Array]  # r(z), shape (m,)
    update: Callable[[Array], None]  # Estimate variances anew at z
    determinant: Callable[[Array], float]  # −log-likelihood beside ½|r|²
    start: Array  # z from which the mode is searched, shape (d,)
    positive: NDArray[np.bool_]  # Which parameters cannot be negative, shape (d,)
    slope: Array = field(init=False)  # Of the determinant at the mode
    mode: Array = field(init=False)
    covariance: Array = field(init=False)
    _order: NDArray[np.intp] = field(init=False)  # Of the columns of J, those that are positive last
    _q: Array = field(init=False)
    _r: Array = field(init=False)
    _inverse: Array = field(init=False)  # R⁻¹, its rows in the order of the parameters
    _offset: Array = field(init=False)  # QᵀF at the mode, zero unless a bound holds it

    def __post_init__(self) -> None:
        self.slope = np.zeros(self.size)
        self.mode = self.start

    @property
    def size(self) -> int:
        """Number d of parameters."""
        return self.start.size

    def stack(self, z: Array) -> Array:
        """F(z): residuals and prior, shape (m + d,)."""
        return np.concatenate([self.residuals(z), z + self.slope])

    def jacobian(self, z: Array) -> Array:
        """Return the derivative of F, shape (m + d, d)."""
        value = self.stack(z)
        return np.stack(
            [(self.stack(z + step) - value) / _STEP for step in _STEP * np.eye(self.size)], axis=-1
        )

    def fit(self, *, updates: int = _UPDATES, iterations: int = _ITERATIONS) -> None:
        """Find the mode, and the covariance there, in so many estimates of variances with steps for each."""
        z = self.mode
        if self.size == 0:
            self.update(z)
            self.covariance = np.zeros((0, 0))
            return
        for _ in range(updates):
            self.update(z)
            z = self._descend(z, iterations)
        self.mode = z
        self._order = np.argsort(self.positive, kind="stable")
        q, r = np.linalg.qr(self.jacobian(z)[:, self._order])
        signs = np.where(np.diag(r) < 0.0, -1.0, 1.0)  # draws of several tests then move alike
        self._q, self._r = q * signs, r * signs[:, np.newaxis]
        self._offset = self._q.T @ self.stack(z)
        self._inverse = np.empty_like(r)
        self._inverse[self._order] = np.linalg.inv(self._r)
        self.covariance = self._inverse @ self._inverse.T

    def _descend(self, z: Array, iterations: int) -> Array:
        for _ in range(iterations):
            self.slope = self._slope(z)
            q, r = np.linalg.qr(self.jacobian(z))
            value = self.stack(z)
            step = self._step(r, q.T @ value, z)
            step *= min(1.0, _LONGEST / max(float(np.abs(step).max()), 1e-300))
            cost = float(value @ value)
            for _ in range(8):
                candidate = self.stack(z + step)
                if float(candidate @ candidate) <= cost + 1e-9:
                    break
                step = 0.5 * step
            z = z + step
            if np.abs(r @ step).max() < _STEP_TOLERANCE:
                break
        return z

    def _step(self, r: Array, projection: Array, z: Array) -> Array:
        """Step to a small |projection + r step| where no parameter becomes negative that cannot be.

        Those that would are held at zero, and the others are solved for again.
        """
        free = np.ones(self.size, dtype=bool)
        while True:
            step = np.where(free, 0.0, -z)
            step[free] = np.linalg.lstsq(r[:, free], -projection - r @ step, rcond=None)[0]
            negative = free & self.positive & (z + step < 0.0)
            if not negative.any():
                return step
            free &= ~negative

    def _slope(self, z: Array) -> Array:
        steps = _STEP * np.eye(self.size)
        return np.array([(self.determinant(z + s) - self.determinant(z - s)) / (2.0 * _STEP) for s in steps])

    def draw(self, count: int, seed: int) -> Draws:
        """Draw from the posterior; if nothing is uncertain, all draws are alike."""
        if self.size == 0:
            return Draws(values=np.zeros((count, 0)), weights=np.full(count, 1.0 / count))
        draws = self._draw(self._normals(count, seed), chords=0)
        if draws.effective >= _ENOUGH * count:
            return draws
        for number in (count, _MORE * count):
            draws = self._draw(self._normals(number, seed), chords=_CHORDS)
            if draws.effective >= min(_FEWEST, number):
                return draws
        return self._sample(count, seed)

    def _normals(self, count: int, seed: int) -> Array:
        """Draw standard normal points, shape (count, d)."""
        return normal_points(self.size, 1 << (count - 1).bit_length(), seed).T[:count]

    def _sample(self, count: int, seed: int) -> Draws:
        """Draw by an ensemble of walkers, slower but right where no approximation holds."""
        import emcee

        walkers = max(2 * _WALKERS * self.size, _FEWEST_WALKERS)
        begin = self._draw(self._normals(walkers, seed), chords=0).values
        moves = [(emcee.moves.DEMove(), 0.8), (emcee.moves.DESnookerMove(), 0.2)]
        sampler = emcee.EnsembleSampler(walkers, self.size, self.log_density, moves=moves)
        start = emcee.State(begin, random_state=np.random.RandomState(seed).get_state())
        sampler.run_mcmc(start, _WALKER_STEPS)
        chain = sampler.get_chain(discard=_WALKER_STEPS // 2, flat=True)
        values = chain[np.linspace(0, len(chain) - 1, count).astype(int)]
        return Draws(values=values, weights=np.full(count, 1.0 / count))

    def _draw(self, normals: Array, *, chords: int) -> Draws:
        """Draw by Laplace's approximation, or by optimisation with up to a number of steps for each draw."""
        points, log_shares = self._cut_off(normals)
        values = self.mode + (points - self._offset) @ self._inverse.T
        values[:, self.positive] = np.maximum(values[:, self.positive], 0.0)  # rounded below zero
        weights = np.empty(len(points))
        for row, point in enumerate(points):
            value = self.stack(values[row])
            for _ in range(chords):
                residual = self._q.T @ value - point
                if not _RESIDUAL_TOLERANCE < np.abs(residual).max() < _DIVERGENCE_LIMIT:
                    break
                values[row] -= self._inverse @ residual
                value = self.stack(values[row])
            cost = float(np.sum((self._q.T @ value) ** 2)) if chords else float(point @ point)
            weights[row] = log_shares[row] - 0.5 * (float(value @ value) - cost)
        is_possible = np.isfinite(weights) & (values[:, self.positive] >= 0.0).all(axis=1)
        if not is_possible.any():
            is_possible[0], weights[0] = True, 0.0  # a single draw, which is too few to be accepted
        weights = np.where(is_possible, weights, -np.inf)
        weights = np.exp(weights - weights.max())
        return Draws(values=values, weights=weights / weights.sum())

    def _cut_off(self, normals: Array) -> tuple[Array, Array]:
        """Move standard normal points such that, by QᵀF = ξ with J constant, no parameter is negative.

        Returns ξ, shape (draws, d), and the logarithm of the share of points that are left, shape (draws,).
        """
        points, log_shares = normals.copy(), np.zeros(len(normals))
        steps = np.zeros_like(points)  # from the mode, in the order of the columns
        for place in range(self.size - int(self.positive.sum()), self.size)[::-1]:
            mode, size = self.mode[self._order[place]], self._r[place, place]
            others = self._offset[place] + steps[:, place + 1 :] @ self._r[place, place + 1 :]
            log_share = scipy.special.log_ndtr(size * mode - others)
            points[:, place] = -scipy.special.ndtri_exp(
                log_share + scipy.special.log_ndtr(-normals[:, place])
            )
            steps[:, place] = np.maximum((points[:, place] - others) / size, -mode)
            log_shares += log_share
        return points, log_shares

    @property
    def log_volume(self) -> float:
        """Logarithm of the prior at the mode times the volume of the posterior, but for a constant."""
        _, log_shares = self._cut_off(self._normals(_POINTS_OF_VOLUME, seed=0))
        return (
            -0.5 * float(self.mode @ self.mode)
            + 0.5 * float(np.linalg.slogdet(self.covariance)[1])
            + 0.5 * float(self._offset @ self._offset)
            + float(scipy.special.logsumexp(log_shares))
            - math.log(_POINTS_OF_VOLUME)
        )

    def log_density(self, z: Array) -> float:
        """Logarithm of the posterior density, but for a constant; −∞ where a world cannot be."""
        if (z[self.positive] < 0.0).any():
            return -np.inf
        with np.errstate(all="ignore"):
            try:
                residuals, determinant = self.residuals(z), self.determinant(z)
            except OverflowError:
                return -np.inf
            density = -0.5 * float(residuals @ residuals) - 0.5 * float(z @ z) - determinant
        return density if np.isfinite(density) else -np.inf
