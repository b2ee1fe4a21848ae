from .cosine import Cosine as Cosine
from .curve import Curve as Curve
from .ellipse import Ellipse as Ellipse
from .inscribed import InscribedEllipse as InscribedEllipse
from .parabola import Parabola as Parabola
