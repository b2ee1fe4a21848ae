"""Length of a rupture from its magnitude.

Wells, D. L. and Coppersmith, K. J. (1994), New empirical relationships among magnitude, rupture length,
rupture width, rupture area, and surface displacement, Bull. Seismol. Soc. Am. 84(4), 974-1002, Table 2A,
subsurface rupture length: log10(RLD) = a + b M, with the standard deviation s of log10(RLD).
"""

from typing import Final

from reliab.motions.synthetic.scenario import Mechanism

# slip type: a, b, s
_TABLE_2A: Final = {
    Mechanism.STRIKE_SLIP: (-2.57, 0.62, 0.15),
    Mechanism.REVERSE: (-2.42, 0.58, 0.16),
}


def rupture_length(magnitude: float, mechanism: Mechanism, *, deviation: float = 0.0) -> float:
    """Length of the rupture below the ground [km].

    >>> round(rupture_length(7.0, Mechanism.STRIKE_SLIP), 1)
    58.9
    """
    a, b, s = _TABLE_2A[mechanism]
    return float(10.0 ** (a + b * magnitude + s * deviation))
