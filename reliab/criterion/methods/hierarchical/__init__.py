"""All structures learned together: a model of earthquakes, motions and structures, sampled by MCMC."""

from reliab.criterion.methods.hierarchical.fit import HierarchicalFit, hierarchical_model
from reliab.criterion.methods.hierarchical.method import HierarchicalNormal, HierarchicalRobust
from reliab.criterion.methods.hierarchical.model import Hierarchical

__all__ = [
    "Hierarchical",
    "HierarchicalFit",
    "HierarchicalNormal",
    "HierarchicalRobust",
    "hierarchical_model",
]
