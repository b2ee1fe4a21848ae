"""What to improve first on a rig, and how far."""

from dataclasses import dataclass

import numpy as np

from reliab.vocabulary import MILLI


@dataclass(frozen=True, kw_only=True)
class Improvement:
    """Which of the two errors weighs more, and what would be tolerable."""

    first: str  # The error with the greater part of the index
    share_of_delay: float  # Part of the delay in the index [-]
    # Delay [s] up to which the test is accepted at its own amplitude; 0 where no delay is small enough
    tolerable_delay: float
    # Amplitude error |A − 1| [-] up to which it is accepted at its own delay; likewise
    tolerable_amplitude_error: float


def improvement(amplitude: float, delay: float, a: float, b: float) -> Improvement:
    """Divide the index of a test between its two errors.

    >>> found = improvement(1.003, 0.0012, 5.3e-5, 1.04)
    >>> found.first, round(found.share_of_delay, 2), round(1e3 * found.tolerable_delay, 3)
    ('delay', 0.89, 0.929)
    """
    of_amplitude = _part((amplitude - 1.0) ** 2, a)
    of_delay = _part((MILLI * delay) ** 2, b)
    total = of_amplitude + of_delay
    share = 0.5 if total == 0.0 or np.isinf(total) else of_delay / total
    return Improvement(
        first="delay" if of_delay >= of_amplitude else "amplitude",
        share_of_delay=share,
        tolerable_delay=float(np.sqrt(max(1.0 - of_amplitude, 0.0) * b)) / MILLI,
        tolerable_amplitude_error=float(np.sqrt(max(1.0 - of_delay, 0.0) * a)),
    )


def _part(square: float, limit: float) -> float:
    if limit > 0.0:
        return square / limit
    return 0.0 if square == 0.0 else np.inf
