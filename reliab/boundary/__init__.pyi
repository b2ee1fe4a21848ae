from .contour import (
    REACH as REACH,
    Contour as Contour,
    furthest_lead as furthest_lead,
    trace_contours as trace_contours,
)
from .curves.cosine import Cosine as Cosine
from .curves.curve import Curve as Curve
from .curves.ellipse import Ellipse as Ellipse
from .curves.inscribed import InscribedEllipse as InscribedEllipse
from .curves.parabola import Parabola as Parabola
from .first_order import first_order_ellipse as first_order_ellipse
from .motion_boundary import SolvedLoop as SolvedLoop, motion_contours as motion_contours
from .suite_boundary import suite_contours as suite_contours
from .surface import (
    DELAY_SCALE as DELAY_SCALE,
    GAIN_SCALE as GAIN_SCALE,
    ErrorSurfaces as ErrorSurfaces,
    stretched as stretched,
)
