"""What a stated confidence can mean, one method per file."""

from reliab.criterion.methods.method import Method
from reliab.criterion.methods.quantile import Quantile
from reliab.criterion.methods.registry import METHODS, method_of

__all__ = ["METHODS", "Method", "Quantile", "method_of"]
