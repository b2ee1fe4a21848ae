from .bound import BoundMethod as BoundMethod, Scatter as Scatter, limits as limits
from .conformal import Conformal as Conformal
from .dirichlet import Dirichlet as Dirichlet
from .hierarchical.method import (
    HierarchicalNormal as HierarchicalNormal,
    HierarchicalRobust as HierarchicalRobust,
)
from .method import Learned as Learned, Method as Method
from .order_statistic import OrderStatistic as OrderStatistic
from .predictive import Predictive as Predictive
from .quantile import Quantile as Quantile
from .registry import METHODS as METHODS, RECOMMENDED as RECOMMENDED, method_of as method_of
from .tolerance import Tolerance as Tolerance, tolerance_factor as tolerance_factor
