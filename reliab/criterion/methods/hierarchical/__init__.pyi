from .fit import hierarchical_model as hierarchical_model
from .method import HierarchicalNormal as HierarchicalNormal, HierarchicalRobust as HierarchicalRobust
