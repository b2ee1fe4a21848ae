"""A ground motion as the excitation of a test, with the window over which its error is taken."""

from reliab.indices import Window
from reliab.motions import Motion
from reliab.simulation import Excitation


def excitation_of(motion: Motion, window: Window) -> Excitation:
    """Return the excitation that a ground motion is within a window.

    Parameters
    ----------
    motion : Motion
        The ground motion.
    window : Window
        Stretch of the record over which the error is taken.

    Returns
    -------
    Excitation
        The whole record, with the bounds of the window [s].

    Examples
    --------
    >>> from reliab.motions import load_motions
    >>> motion = load_motions("synthetic")[0]
    >>> excitation_of(motion, Window()).time_step == motion.time_step
    True
    """
    bounds = window.bounds(motion.acceleration, motion.time_step)
    return Excitation(acceleration=motion.acceleration, time_step=motion.time_step, window=bounds)
