"""What a stated confidence can mean, one method per file.

Which to use: `quantile` repeats the paper. `dirichlet`, jointly for a and b, is recommended: it keeps its
promise on average for few and many earthquakes, skewed or not. `tolerance`, `posterior`, `order_statistic`
and `bootstrap` keep it with an assurance, at the price of a smaller region. `conformal` assumes least and
needs most earthquakes. `hierarchical` learns all structures together, from a posterior that is sampled.
"""

from reliab.criterion.methods.bootstrap import Bootstrap
from reliab.criterion.methods.conformal import Conformal
from reliab.criterion.methods.dirichlet import Dirichlet
from reliab.criterion.methods.hierarchical import HIERARCHICAL, HierarchicalPosterior
from reliab.criterion.methods.method import Method
from reliab.criterion.methods.order_statistic import OrderStatistic
from reliab.criterion.methods.posterior import Posterior
from reliab.criterion.methods.predictive import Predictive
from reliab.criterion.methods.quantile import Quantile
from reliab.criterion.methods.registry import METHODS, RECOMMENDED, any_method_of, method_of
from reliab.criterion.methods.tolerance import Tolerance, tolerance_factor

__all__ = [
    "HIERARCHICAL",
    "METHODS",
    "RECOMMENDED",
    "Bootstrap",
    "Conformal",
    "Dirichlet",
    "HierarchicalPosterior",
    "Method",
    "OrderStatistic",
    "Posterior",
    "Predictive",
    "Quantile",
    "Tolerance",
    "any_method_of",
    "method_of",
    "tolerance_factor",
]
