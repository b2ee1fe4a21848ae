from .cut_records import measure_cut_records as measure_cut_records
from .ellipse_dataset import CURVES as CURVES, share_at_rest as share_at_rest
from .ellipse_file import (
    open_ellipses as open_ellipses,
    open_windows as open_windows,
    write_ellipses as write_ellipses,
)
from .ellipse_table import (
    EllipseRequest as EllipseRequest,
    predict_ellipses as predict_ellipses,
    trace_ellipses as trace_ellipses,
)
from .frame_table import (
    FrameRequest as FrameRequest,
    errors_of_rig as errors_of_rig,
    limits_of_coupling as limits_of_coupling,
    summary_of_rig as summary_of_rig,
    trace_frame_ellipses as trace_frame_ellipses,
)
from .grid import ExplicitGrid as ExplicitGrid, ScaledGrid as ScaledGrid
from .labels import outlines_of as outlines_of
from .netcdf import packed as packed, read_netcdf as read_netcdf, write_netcdf as write_netcdf
from .plain import (
    WHOLLY_EXPERIMENTAL as WHOLLY_EXPERIMENTAL,
    Motions as Motions,
    StatedStructures as StatedStructures,
    one_of as one_of,
    suite_of as suite_of,
    sweep_request as sweep_request,
)
from .request import SweepRequest as SweepRequest, excitation_of as excitation_of
from .response_measures import (
    compare_boundaries as compare_boundaries,
    measure_responses as measure_responses,
)
from .results import (
    REAL as REAL,
    open_results as open_results,
    real_results as real_results,
    stored_results as stored_results,
    write_compact as write_compact,
)
from .run import run_sweep as run_sweep
from .several import Names as Names, Numbers as Numbers, several as several
from .shares import (
    at_share as at_share,
    for_each_share as for_each_share,
    share_of as share_of,
    shares_of as shares_of,
)
from .store_layout import attributes as attributes
