"""What a stated confidence can mean, one method per file.

Which to use: `quantile` repeats the paper. `dirichlet`, jointly for a and b, is recommended: it keeps its
promise on average for few and many earthquakes, skewed or not. `tolerance`, `posterior`, `order_statistic`
and `bootstrap` keep it with an assurance, at the price of a smaller region. `conformal` assumes least and
needs most earthquakes. `hierarchical` learns all structures together, from a posterior that is sampled.
"""

from reliab.criterion.methods.bootstrap import Bootstrap
from reliab.criterion.methods.bound import BoundMethod, limits
from reliab.criterion.methods.conformal import Conformal
from reliab.criterion.methods.dirichlet import Dirichlet
from reliab.criterion.methods.hierarchical import HierarchicalNormal, HierarchicalRobust
from reliab.criterion.methods.joint import Scatter
from reliab.criterion.methods.method import Learned, Method
from reliab.criterion.methods.order_statistic import OrderStatistic
from reliab.criterion.methods.posterior import Posterior
from reliab.criterion.methods.predictive import Predictive
from reliab.criterion.methods.quantile import Quantile
from reliab.criterion.methods.registry import METHODS, RECOMMENDED, method_of
from reliab.criterion.methods.tolerance import Tolerance, tolerance_factor

__all__ = [
    "METHODS",
    "RECOMMENDED",
    "Bootstrap",
    "BoundMethod",
    "Conformal",
    "Dirichlet",
    "HierarchicalNormal",
    "HierarchicalRobust",
    "Learned",
    "Method",
    "OrderStatistic",
    "Posterior",
    "Predictive",
    "Quantile",
    "Scatter",
    "Tolerance",
    "limits",
    "method_of",
    "tolerance_factor",
]
