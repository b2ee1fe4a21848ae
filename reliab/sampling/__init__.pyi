from .ensembles import Ensembles as Ensembles, draw as draw, sample as sample, width_of as width_of
from .laplace import Laplace as Laplace
from .model import Model as Model, Parameter as Parameter
from .normal_inverse_chi_squared import NormalInverseChiSquared as NormalInverseChiSquared
from .posterior_sample import (
    ConvergenceWarning as ConvergenceWarning,
    PosteriorSample as PosteriorSample,
    walkers_in_turn as walkers_in_turn,
)
