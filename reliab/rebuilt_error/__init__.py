"""The error of a test, rebuilt from its own command and measured displacement (plain arrays, SI units).

:func:`rebuild` is the way in::

    error = rebuild(command, measured, time_step, structure, tolerances=Tolerances(frequency=0.01))
    error.rms.value, error.rms.low, error.rms.high      RMS^R and its 90 % interval; error.mte alike
    error.probability(threshold, metric)                P(error < threshold), capped by the draws
    error.error, error.smooth_error, error.reference    x_m − x_I and x_I [m], shape (n,)
    error.low, error.high                               90 % band of x_m − x_I [m], shape (n,)
    error.parts()                                       Parts: gain, delay, first, by_name[...] with share,
                                                        rms, remaining_rms, remaining_mte, history
    error.widenings(metric)                             what widens the interval, widest first
    error.start.offset, error.noise.white               the sensor's offset and noise [m]

`structure` is a :class:`~reliab.loop.structure.Structure` (one degree of freedom, share α) or a
:class:`WholeStructure` (matrices M, C, K with an interface and a specimen).
"""

from reliab.rebuilt_error.interval import Estimate, Widening
from reliab.rebuilt_error.parts import Part, Parts
from reliab.rebuilt_error.rebuild import rebuild
from reliab.rebuilt_error.rebuilt import RebuiltError
from reliab.rebuilt_error.tolerances import Tolerances
from reliab.rebuilt_error.whole_structure import WholeStructure

__all__ = [
    "Estimate",
    "Part",
    "Parts",
    "RebuiltError",
    "Tolerances",
    "WholeStructure",
    "Widening",
    "rebuild",
]
