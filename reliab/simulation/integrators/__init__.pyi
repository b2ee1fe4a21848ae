from .central_difference import CentralDifference as CentralDifference
from .chen_ricles import ChenRicles as ChenRicles
from .coarse import CoarseExplicit as CoarseExplicit
from .integrator import ExactIntegrator as ExactIntegrator, Integrator as Integrator
from .operator_splitting import OperatorSplitting as OperatorSplitting
