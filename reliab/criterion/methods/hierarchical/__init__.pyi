from .fit import HierarchicalFit as HierarchicalFit, hierarchical_model as hierarchical_model
from .method import HierarchicalNormal as HierarchicalNormal, HierarchicalRobust as HierarchicalRobust
from .model import Hierarchical as Hierarchical
