"""The error by the discrete Fourier transform: an oracle of the recursion that shares nothing with it."""

import numpy as np

from reliab.assessment.rebuilt_error.force_form import filtered


def respond_spectrally(structure, difference, time_step):
    """Error of the interface from x_c − x_m, from rest [m]."""
    moved = np.linalg.solve(structure.mass, structure.interface @ structure.specimen_mass)
    at_once = float((structure.interface.T @ moved)[0, 0])
    rest = filtered(lambda s: structure.error_transfer(s)[:, 0, 0] - at_once, difference, time_step)
    return at_once * difference + rest
