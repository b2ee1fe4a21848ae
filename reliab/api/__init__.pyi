from .arguments import unused as unused
from .assessment import assess as assess
from .boundaries import ellipses as ellipses
from .design import Design as Design, design_test as design_test
from .simulation import simulate as simulate
