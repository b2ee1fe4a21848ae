"""From a grid of actuators to a labelled dataset: storage, resume, clusters.

Everything is imported on first use, since reading ellipses needs neither kernels nor the storage library.
"""

from typing import TYPE_CHECKING

from reliab.lazy_exports import exports

if TYPE_CHECKING:
    from reliab.sweep.compact import write_compact
    from reliab.sweep.ellipse_dataset import CURVES, share_at_rest
    from reliab.sweep.ellipse_file import open_ellipses, open_windows, write_ellipses
    from reliab.sweep.ellipse_table import EllipseRequest, trace_ellipses
    from reliab.sweep.first_order_table import predict_ellipses
    from reliab.sweep.grid import ExplicitGrid, Grid, ScaledGrid
    from reliab.sweep.request import SweepRequest
    from reliab.sweep.results import open_results
    from reliab.sweep.run import run_sweep
    from reliab.sweep.shares import at_share, shares_of

_HOMES = {
    "CURVES": "reliab.sweep.ellipse_dataset",
    "EllipseRequest": "reliab.sweep.ellipse_table",
    "ExplicitGrid": "reliab.sweep.grid",
    "Grid": "reliab.sweep.grid",
    "ScaledGrid": "reliab.sweep.grid",
    "SweepRequest": "reliab.sweep.request",
    "at_share": "reliab.sweep.shares",
    "open_ellipses": "reliab.sweep.ellipse_file",
    "open_results": "reliab.sweep.results",
    "open_windows": "reliab.sweep.ellipse_file",
    "predict_ellipses": "reliab.sweep.first_order_table",
    "run_sweep": "reliab.sweep.run",
    "share_at_rest": "reliab.sweep.ellipse_dataset",
    "shares_of": "reliab.sweep.shares",
    "trace_ellipses": "reliab.sweep.ellipse_table",
    "write_compact": "reliab.sweep.compact",
    "write_ellipses": "reliab.sweep.ellipse_file",
}

__all__ = [
    "CURVES",
    "EllipseRequest",
    "ExplicitGrid",
    "Grid",
    "ScaledGrid",
    "SweepRequest",
    "at_share",
    "open_ellipses",
    "open_results",
    "open_windows",
    "predict_ellipses",
    "run_sweep",
    "share_at_rest",
    "shares_of",
    "trace_ellipses",
    "write_compact",
    "write_ellipses",
]

__getattr__ = exports(__name__, _HOMES)
