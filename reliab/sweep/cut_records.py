"""Ratios by which the ellipses of ground motions change when their records are cut, with labels."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from reliab.core.shipped import shipped
from reliab.core.untrusted_files import open_hdf5
from reliab.motions.motion import Motion, arias_times
from reliab.structures.structure import Structure
from reliab.sweep.labels import label_variables, share_of
from reliab.tracking.boundary.finite_errors import CUT_LENGTHS, ratios_of_cut_record
from reliab.tracking.boundary.first_order import exact_response
from reliab.tracking.indices.window import Window

_ONSET = 0.01  # share of the Arias intensity that has passed at the onset of shaking
_SHIPPED_ELLIPSES = "real_suite/ellipses.nc"
_CUT_DIMENSIONS = ("motion", "f", "xi", "length")
_LEAD_IN = 1.0  # s, of a record before its onset


def measure_cut_records(
    motions: Sequence[Motion], frequencies: Sequence[float], damping_ratios: Sequence[float], share: float
) -> xr.Dataset:
    """Measure how a and b change when records are cut to other lengths.

    `motions` are read one at a time; `frequencies` [Hz]; `share` of the stiffness in the laboratory [-].
    Returns `a_cut` and `b_cut` [-], a and b of a cut record over those of the whole one, over (motion, f, xi,
    length).

    >>> from reliab.motions.loading import load_motions
    >>> measured = measure_cut_records(load_motions("synthetic")[:2], [1.0], [0.02, 0.05], 1.0)
    >>> bool((measured["a_cut"].sel(length=10.0) < 1.5).all())
    True
    """
    sizes = len(frequencies), len(damping_ratios), len(CUT_LENGTHS)
    structures = [
        Structure(frequency=f, damping_ratio=xi, experimental_fraction=share)
        for f in frequencies
        for xi in damping_ratios
    ]
    ratios = np.array([_motion_ratios(motion, structures) for motion in motions]).reshape(-1, *sizes, 2)
    return label_variables(
        xr.Dataset(
            {name: (_CUT_DIMENSIONS, ratios[..., place]) for place, name in enumerate(("a_cut", "b_cut"))},
            coords={"length": list(CUT_LENGTHS)},
        )
    )


def add_known_cut_records(ellipses: xr.Dataset) -> xr.Dataset:
    """Add the ratios that ship to ellipses of whole records that ship, at the structures of these.

    Records are known by their checksums. Other ellipses stay as they are.
    """
    is_full_record = str(ellipses.attrs.get("window")) == Window().label and share_of(ellipses) == 1.0
    if not is_full_record or "checksum" not in ellipses.coords:
        return ellipses
    with open_hdf5(shipped("datasets", _SHIPPED_ELLIPSES), ships=True) as file:
        records, *axes = (file[name][()] for name in ("checksum", "f", "xi"))
        rows = {text.decode(): row for row, text in enumerate(records.tolist())}
        places = [[rows.get(text) for text in ellipses["checksum"].values.tolist()]]
        for axis, name in zip(axes, ("f", "xi"), strict=True):
            near = np.isclose(ellipses[name].values[:, None], axis, rtol=1e-9)
            places.append([int(row.argmax()) if row.any() else None for row in near])
        if any(None in axis_places for axis_places in places):
            return ellipses
        ratios = {name: (_CUT_DIMENSIONS, file[name][()][np.ix_(*places)]) for name in ("a_cut", "b_cut")}
        return label_variables(ellipses.assign(ratios).assign_coords(length=file["length"][()]))


def _motion_ratios(motion: Motion, structures: Sequence[Structure]) -> list[np.ndarray]:
    """Ratios of one motion for each structure."""
    acceleration, time_step = motion.acceleration, motion.time_step
    onset = max(float(arias_times(acceleration, time_step, [_ONSET])[0]) - _LEAD_IN, 0.0)
    return [
        ratios_of_cut_record(exact_response(acceleration, time_step, structure), time_step, structure, onset)
        for structure in structures
    ]
