from .contour import (
    AMPLITUDE_STEP as AMPLITUDE_STEP,
    DELAY_SCALE as DELAY_SCALE,
    GAIN_SCALE as GAIN_SCALE,
    REACH as REACH,
    Contour as Contour,
    ErrorSurfaces as ErrorSurfaces,
    furthest_lead as furthest_lead,
    stretched as stretched,
    trace_contours as trace_contours,
)
from .curves import (
    Cosine as Cosine,
    Curve as Curve,
    Ellipse as Ellipse,
    InscribedEllipse as InscribedEllipse,
    Parabola as Parabola,
)
from .cut_records import (
    CUT_LENGTHS as CUT_LENGTHS,
    ratios_of_cut_record as ratios_of_cut_record,
)
from .finite_errors import (
    DIRECTIONS as DIRECTIONS,
    predicted_ellipse as predicted_ellipse,
    ratio_of_delays as ratio_of_delays,
    scales_of_contour as scales_of_contour,
)
from .first_order import (
    FirstOrderEllipse as FirstOrderEllipse,
    ellipse_of_response as ellipse_of_response,
    exact_response as exact_response,
    first_order_ellipse as first_order_ellipse,
)
from .suite_boundary import (
    SolvedLoop as SolvedLoop,
    motion_contours as motion_contours,
    suite_contours as suite_contours,
)
