"""The low-pass filter that adaptive compensators share: second-order sections, one sample at a time."""

from reliab.compiled import compiled
from reliab.effects import Numbers

SECTIONS = 2
"""Second-order sections of the filter: one of order four."""


@compiled
def filter_two(
    sent: float,
    measured: float,
    state: Numbers,
    memory: int,
    coefficients: Numbers,
    first: int,
) -> tuple[float, float]:
    """Filter the command that was sent and the measurement alike, so that both are delayed equally.

    `sent`, `measured` [m]; returns [m].
    """
    u, y = sent, measured
    for section in range(SECTIONS):
        at, place = first + 5 * section, memory + 2 * section
        b0, b1, b2 = coefficients[at], coefficients[at + 1], coefficients[at + 2]
        a1, a2 = coefficients[at + 3], coefficients[at + 4]
        filtered = b0 * u + state[place]
        state[place] = b1 * u - a1 * filtered + state[place + 1]
        state[place + 1] = b2 * u - a2 * filtered
        u = filtered
        filtered = b0 * y + state[place + 4]
        state[place + 4] = b1 * y - a1 * filtered + state[place + 5]
        state[place + 5] = b2 * y - a2 * filtered
        y = filtered
    return u, y
