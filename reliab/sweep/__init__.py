"""From a grid of actuators to a labelled dataset: storage, resume, clusters.

Functions that need the storage library are imported on first use.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from reliab.sweep.ellipse_dataset import CURVES, share_at_rest
from reliab.sweep.ellipse_file import ellipse_windows, open_ellipses, open_windows, write_ellipses
from reliab.sweep.ellipse_table import EllipseRequest, trace_ellipses
from reliab.sweep.first_order_table import predict_ellipses
from reliab.sweep.grid import ExplicitGrid, Grid, ScaledGrid
from reliab.sweep.request import SweepRequest

if TYPE_CHECKING:
    from reliab.sweep.compact import write_compact
    from reliab.sweep.results import open_results
    from reliab.sweep.run import run_sweep

_HOMES = {
    "open_results": "reliab.sweep.results",
    "run_sweep": "reliab.sweep.run",
    "write_compact": "reliab.sweep.compact",
}

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
    "open_windows",
    "predict_ellipses",
    "run_sweep",
    "share_at_rest",
    "trace_ellipses",
    "write_compact",
    "write_ellipses",
]


def __getattr__(name: str) -> Any:  # noqa: ANN401 - functions of several types
    if name not in _HOMES:
        message = f"module 'reliab.sweep' has no attribute {name!r}"
        raise AttributeError(message)
    return getattr(import_module(_HOMES[name]), name)
