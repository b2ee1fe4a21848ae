from .adding import Addition as Addition, add as add
from .posterior import Posterior as Posterior
