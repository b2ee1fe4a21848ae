"""Uncertainty of the index, from blocks of the residual that a gain and a delay leave of the displacement.

The index is linear in the measured displacement, so that each stretch of the remainder contributes to its
error on its own. Blocks of contributions, long enough that neighbours are unrelated, get random weights
(dependent wild bootstrap, Shao 2010), each as if the index had been found without its block (delete-one
jackknife), with the heavier tails of Student's t where a few blocks hold most of the motion.

References
----------
Politis, D. N. (2003). Adaptive bandwidth choice. *Journal of Nonparametric Statistics* 15, 517-533.
Shao, X. (2010). The dependent wild bootstrap. *Journal of the American Statistical Association* 105, 218-235.
"""

import numpy as np
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.signals import taper

_CELLS = 1024  # stretches whose contributions are summed before blocks are formed
_RUN = 5  # lags that must be quiet
_FEWEST_BLOCKS = 12
_REACHES = 3  # length of a block in lags at which contributions are still correlated
_HIGHEST_LEVERAGE = 0.9


def index_errors(
    command: Array, residual: Array, *, window: str = "hann", draws: int = 2000, seed: int = 0
) -> NDArray[np.complex128]:
    """Draw errors of FEI that noise may have caused.

    `command`, `residual` [m]; returns [-].

    >>> time = np.arange(0.0, 40.0, 0.01)
    >>> noise = 0.01 * np.random.default_rng(1).normal(size=time.size)
    >>> found = index_errors(np.sin(6.0 * time), noise)
    >>> round(float(found.real.std()), 4)  # 0.01 √(2 · 1.94 / 4000)
    0.0003
    """
    contribution, energy = _contributions(command, residual, window)
    blocks, leverage = _blocks(contribution, energy)
    rng = np.random.default_rng(seed)
    parts = np.ascontiguousarray(blocks / (1.0 - leverage)).view(np.float64).reshape(-1, 2)
    sums = rng.multivariate_normal(np.zeros(2), parts.T @ parts, draws)  # of blocks with normal weights
    freedom = max(1.0 / float(np.sum(leverage**2)) - 1.0, 1.0)
    tails = np.sqrt(freedom / rng.chisquare(freedom, draws))
    return np.asarray(tails * (sums[:, 0] + 1j * sums[:, 1]), dtype=np.complex128)


def _contributions(command: Array, residual: Array, window: str) -> tuple[NDArray[np.complex128], Array]:
    """Sum of a stretch's part in Σ F[left] F[I]* / Σ|F[I]|², and its share in the command's energy."""
    weights = taper(window, command.size)
    points = 1 << (command.size - 1).bit_length()
    spectrum = np.fft.fft(command * weights, points)
    spectrum[0], spectrum[points // 2 :] = 0.0, 0.0
    analytic = weights * np.fft.ifft(spectrum)[: command.size] * points
    edges = np.linspace(0, command.size, min(_CELLS, command.size) + 1).astype(np.int64)[:-1]
    parts = np.add.reduceat(residual * analytic.conj(), edges) / float(np.sum(np.abs(spectrum) ** 2))
    energy = np.add.reduceat(np.abs(analytic) ** 2, edges)
    return np.asarray(parts, dtype=np.complex128), energy / energy.sum()


def _blocks(contribution: NDArray[np.complex128], energy: Array) -> tuple[NDArray[np.complex128], Array]:
    effective = 1.0 / float(np.sum(energy**2))
    reach = max(_reach(part, effective) for part in (contribution.real, contribution.imag))
    length = min(max(_REACHES * reach, 1), contribution.size // _FEWEST_BLOCKS)
    edges = np.arange(0, contribution.size, max(length, 1))
    leverage = np.minimum(np.add.reduceat(energy, edges), _HIGHEST_LEVERAGE)
    return np.asarray(np.add.reduceat(contribution, edges), dtype=np.complex128), leverage


def _reach(values: Array, effective: float) -> int:
    """Lag beyond which values are no longer correlated (Politis 2003), over a number of effective values."""
    centred = values - values.mean()
    spectrum = np.abs(np.fft.rfft(centred, 2 * centred.size)) ** 2
    correlation = np.fft.irfft(spectrum)[: centred.size]
    if not correlation[0] > 0.0:
        return 0
    limit = 2.0 * np.sqrt(np.log10(max(effective, 2.0)) / effective)
    quiet = np.abs(correlation[1:] / correlation[0]) < limit
    runs = np.flatnonzero(np.convolve(quiet, np.ones(_RUN), mode="valid") == _RUN)
    return int(runs[0]) if runs.size else centred.size
