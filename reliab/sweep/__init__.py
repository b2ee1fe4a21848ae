"""From a grid of actuators to a labelled dataset: storage, resume, clusters."""

from reliab.sweep.compact import write_compact
from reliab.sweep.ellipse_dataset import CURVES, share_at_rest
from reliab.sweep.ellipse_file import ellipse_windows, open_ellipses, write_ellipses
from reliab.sweep.ellipse_table import EllipseRequest, trace_ellipses
from reliab.sweep.first_order_table import predict_ellipses
from reliab.sweep.grid import ExplicitGrid, Grid, ScaledGrid
from reliab.sweep.request import SweepRequest
from reliab.sweep.results import open_results
from reliab.sweep.run import run_sweep

__all__ = [
    "CURVES",
    "EllipseRequest",
    "ExplicitGrid",
    "Grid",
    "ScaledGrid",
    "SweepRequest",
    "ellipse_windows",
    "open_ellipses",
    "open_results",
    "predict_ellipses",
    "run_sweep",
    "share_at_rest",
    "trace_ellipses",
    "write_compact",
    "write_ellipses",
]
