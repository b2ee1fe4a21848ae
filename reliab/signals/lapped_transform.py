"""A history as orthonormal coefficients over time and frequency, and back.

Lapped cosine transform: frames of two hops, each overlapping the next by half, under a window that
conserves power (Princen, Johnson and Bradley 1987, IEEE ICASSP; the window is that of the Vorbis
specification, section 4.3.1). White noise of variance σ² gives coefficients of variance σ² that are
uncorrelated; coefficient k of a frame stands at the frequency (k + 1/2)/(2·hop·step).
"""

from functools import lru_cache

import numpy as np
import scipy

from reliab.core.arrays import Array


def analyse(values: Array, hop: int) -> Array:
    """Transform a history."""
    frames = -(-values.size // hop) + 1
    padding = frames * hop - values.size
    start_extension, end_extension = 2.0 * values[0] - values[hop:0:-1], np.full(padding, values[-1])
    reflection = 2.0 * values[-1] - values[-2::-1][:padding]
    end_extension[: reflection.size] = reflection
    blocks = np.concatenate([start_extension, values, end_extension]).reshape(frames + 1, hop)
    window, half = _window(hop), hop // 2
    early, late = blocks[:-1] * window[:hop], blocks[1:] * window[hop:]
    folded_frames = np.concatenate(
        [-late[:, half - 1 :: -1] - late[:, half:], early[:, :half] - early[:, : half - 1 : -1]], axis=1
    )
    return np.asarray(scipy.fft.dct(folded_frames, type=4, norm="ortho", axis=1))


def synthesise(coefficients: Array, size: int) -> Array:
    """Give histories back.

    >>> history = np.cumsum(np.random.default_rng(0).standard_normal(100))
    >>> bool(np.allclose(synthesise(analyse(history, 16)[np.newaxis], 100)[0], history))
    True
    """
    hop = coefficients.shape[-1]
    folded_frames = scipy.fft.dct(coefficients, type=4, norm="ortho", axis=-1)
    window, half = _window(hop), hop // 2
    first, second = folded_frames[..., :half], folded_frames[..., half:]
    early = np.concatenate([second, -second[..., ::-1]], axis=-1) * window[:hop]
    late = np.concatenate([-first[..., ::-1], -first], axis=-1) * window[hop:]
    blocks = early[:, 1:] + late[:, :-1]
    return np.ascontiguousarray(blocks.reshape(coefficients.shape[0], -1)[:, :size])


@lru_cache(maxsize=16)
def _window(hop: int) -> Array:
    place = np.pi * (np.arange(2 * hop) + 0.5) / (2 * hop)
    return np.asarray(np.sin(0.5 * np.pi * np.sin(place) ** 2))
