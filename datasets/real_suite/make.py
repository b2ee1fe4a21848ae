"""Make the shipped results of the real ground motions again from their records.

    python datasets/real_suite/make.py RECORDS [--parts FOLDER] [--workers N]

Each motion is a part of its own, kept in FOLDER, so that an interrupted run resumes where it was.
"""

import argparse
import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from itertools import product
from pathlib import Path

import numpy as np
import xarray as xr

import reliab
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.sweep.cut_records import measure_cut_records
from reliab.sweep.ellipse_dataset import write_ellipses
from reliab.sweep.ellipse_table import measure_responses
from reliab.sweep.labels import outlines_of
from reliab.sweep.netcdf import pack, write_netcdf
from reliab.sweep.request import SweepRequest
from reliab.sweep.results import open_results, write_compact
from reliab.sweep.results_accessor import ResultsAccessor, contours_of
from reliab.tracking.boundary.finite_errors import DIRECTIONS, predict_ellipse, scales_of_contour
from reliab.tracking.boundary.first_order import FirstOrderEllipse
from reliab.tracking.indices.window import Window

HERE = Path(__file__).parent
FREQUENCIES = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0)
DAMPING_RATIOS = (0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.10)
SIX = ((0.5, 1.0, 2.0), (0.02, 0.05))
THRESHOLDS = (0.01, 0.02, 0.03, 0.05, 0.10, 0.20)
METRICS = ("rms", "mte")
NAMES = ("motion", "event", "checksum")
CHUNK = {"direction": 1}  # of first_order.nc; the other dimensions are whole
WINDOWS = ("record", "arias", "10", "15", "20", "30", "40")
STORED_WINDOWS = ("record", "40", "30", "20", "15", "10", "arias")  # each resembles the one before


def bounds(motion: Motion, label: str) -> tuple[float, float]:
    """Begin and end of a window [s]."""
    return Window.parse(label).bounds(motion.acceleration, motion.time_step)


def make_part(records: str, index: int, folder: Path) -> None:
    """Simulate one motion in every window and trace its boundaries on the stored grid."""
    motions = load_motions(records)[index : index + 1]
    motion = motions[0]
    # A window that is longer than the record is the record.
    distinct = {bounds(motion, label): label for label in reversed(WINDOWS)}
    with tempfile.TemporaryDirectory() as scratch:
        store = Path(scratch) / "results.zarr"
        windows = [label for label in WINDOWS if label in distinct.values()]
        reliab.simulate(motions, out=store, f=FREQUENCIES, xi=DAMPING_RATIOS, window=windows, workers=1)
        traced = {}
        for label in windows:
            results = open_results(store, window=label).load()
            traced[label] = reliab.ellipses(results, threshold=THRESHOLDS, metric=METRICS)
            if label == "record":
                write_compact(results, folder / f"results_{index:03d}.nc")
    parts = [traced[distinct[bounds(motion, label)]] for label in WINDOWS]
    several = xr.concat(
        parts, dim="window", data_vars="all", combine_attrs="drop_conflicts", coords="minimal"
    )
    part = folder / f"ellipses_{index:03d}.nc"
    write_ellipses(several.assign_coords(window=list(WINDOWS)), part.with_suffix(".tmp"))
    part.with_suffix(".tmp").rename(part)


def small(ellipses: xr.Dataset) -> xr.Dataset:
    """Round a and b to 0.4 %, and misfits, of fitted ellipses of RMS^R for lags alone, to 3 %."""
    ellipses = ellipses.drop_vars("n").sel(window=list(STORED_WINDOWS))
    for name, neighbour in (("a", "side"), ("b", "curve")):
        along = ("xi", "threshold", neighbour, "window")
        ellipses = pack(ellipses, (name,), step=8e-3, dimensions=along, unknown="no_ellipse")
    fitted, of_rms, of_lags = (
        ellipses[name] == label for name, label in (("curve", "ellipse"), ("metric", "rms"), ("side", "lag"))
    )
    return ellipses.assign(
        sse=rounded(ellipses["sse"].where(fitted & of_rms & of_lags), 16.0),
        error_at_rest=rounded(ellipses["error_at_rest"], 2048.0),
    )


def with_cut_records(ellipses: xr.Dataset, motions: Sequence[Motion]) -> xr.Dataset:
    """Add the ratios of cut records, rounded to 0.8 %, and outlines of the records."""
    ratios = measure_cut_records(motions, FREQUENCIES, DAMPING_RATIOS, 1.0)
    ellipses = ellipses.assign_coords(outline=outlines_of(motions))
    return ellipses.merge(ratios.map(lambda values: rounded(values, 64.0)))


def rounded(values: xr.DataArray, parts: float) -> xr.DataArray:
    """Round numbers to one of so many parts of the next power of two."""
    mantissa, exponent = np.frexp(values.values)
    return values.copy(data=np.ldexp(np.round(mantissa * parts) / parts, exponent).astype(np.float32))


def write_measures(measures: xr.Dataset) -> None:
    """Write `first_order.nc`, the multiples in steps of 0.4 and 1.6 % (they scatter by 6 %)."""
    measures = measures.astype(np.float32)
    measures["unknown"] = (~np.isfinite(measures["scale"])).astype(np.int8)
    for name, step in (("scale", 4e-3), ("scale_towards", 1.6e-2)):
        measures = pack(measures, (name,), step=step, dimensions=("threshold", "xi"), unknown="unknown")
    encoding = {
        str(name): {
            "zlib": True,
            "complevel": 9,
            "shuffle": True,
            "chunksizes": tuple(min(CHUNK.get(str(dim), size), size) for dim, size in values.sizes.items()),
        }
        for name, values in measures.data_vars.items()
    }
    write_netcdf(measures, HERE / "first_order.nc", encoding=encoding)


def compare_boundaries(results: xr.Dataset, measures: xr.Dataset, thresholds: Sequence[float]) -> xr.Dataset:
    """Compare the boundaries of stored results with those that the exact responses predict.

    `results`: errors RMS^R of whole records over the grid of actuators, wholly experimental; `measures`: what
    `measure_responses` returned for the same motions and structures; `thresholds`: errors on the boundaries
    [-]. Returns `measures` with `scale` [-] over (motion, f, xi, threshold, side), the largest multiple of a
    and b of the predicted ellipse that lies wholly inside the boundary, and `scale_towards` [-], in addition
    over the `direction` [degrees] in the ellipse's own angle, the multiple that reaches the boundary there.
    """
    accessor = ResultsAccessor(results)
    pairs = [(threshold, side) for threshold in thresholds for side in accessor.sides]
    sizes = [results.sizes[name] for name in ("motion", "f", "xi")]
    scales = np.full((*sizes, len(pairs), 1 + DIRECTIONS.size), np.nan)
    for row, column in product(range(sizes[1]), range(sizes[2])):
        structure_place = {"f": float(results["f"][row]), "xi": float(results["xi"][column])}
        structure, structure_measures = accessor.structure(**structure_place), measures.sel(structure_place)
        contours = contours_of(accessor.select_structure(**structure_place)["rms"], structure, pairs)
        for motion, motion_contours in enumerate(contours):
            response = response_of(structure_measures.isel(motion=motion))
            scales[motion, row, column] = [
                scales_of_contour(contour, *predict_ellipse(response, structure, *pair))
                for contour, pair in zip(motion_contours, pairs, strict=True)
            ]
    scales = scales.reshape(*sizes, len(thresholds), len(accessor.sides), -1)
    dimensions = ("motion", "f", "xi", "threshold", "side")
    return measures.assign(
        {
            "scale": (dimensions, scales[..., 0]),
            "scale_towards": ((*dimensions, "direction"), scales[..., 1:]),
        }
    ).assign_coords(
        threshold=list(thresholds),
        side=[str(side) for side in accessor.sides],
        direction=np.degrees(DIRECTIONS),
    )


def response_of(measures: xr.Dataset) -> FirstOrderEllipse:
    """Response to one motion."""
    names = ("a_first", "b_first", "effective_duration", "duration")
    amplitude, delay, effective, duration = (float(measures[name]) for name in names)
    return FirstOrderEllipse(
        amplitude=amplitude, delay=delay, effective_duration=effective, duration=duration
    )


def joined(parts: Path, name: str, count: int) -> xr.Dataset:
    """Join the parts of all motions, which differ in the windows that a short record needs."""
    files = [xr.load_dataset(parts / f"{name}_{index:03d}.nc", engine="h5netcdf") for index in range(count)]
    # Names of a fixed width would be cut to that of the first.
    files = [file.assign_coords({key: file[key].astype(object) for key in NAMES}) for file in files]
    whole = xr.concat(files, dim="motion", data_vars="minimal", combine_attrs="drop_conflicts")
    request = SweepRequest(
        frequencies=FREQUENCIES,
        damping_ratios=DAMPING_RATIOS,
        windows=tuple(Window.parse(label) for label in WINDOWS),
    )
    return whole.assign_attrs(study_hash=request.digest())


def main() -> None:
    """Make all parts, then both files."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("records")
    parser.add_argument("--parts", type=Path, default=Path("real_suite_parts"))
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    given.parts.mkdir(parents=True, exist_ok=True)
    count = len(load_motions(given.records))
    missing = [index for index in range(count) if not (given.parts / f"ellipses_{index:03d}.nc").exists()]
    with ProcessPoolExecutor(given.workers) as pool:
        jobs = [pool.submit(make_part, given.records, index, given.parts) for index in missing]
        for done, job in enumerate(as_completed(jobs), start=count - len(missing) + 1):
            job.result()
            print(f"{done} of {count}", flush=True)
    motions = load_motions(given.records)
    ellipses = with_cut_records(small(joined(given.parts, "ellipses", count)), motions)
    write_ellipses(ellipses, HERE / "ellipses.nc")
    results = joined(given.parts, "results", count)
    of_six = results.sel(f=list(SIX[0]), xi=list(SIX[1]))
    write_compact(of_six, HERE / "results_of_six.nc", step=2e-3)
    write_compact(results, HERE / "results.nc")
    measures = measure_responses(motions, FREQUENCIES, DAMPING_RATIOS)
    write_measures(compare_boundaries(open_results(HERE / "results.nc").load(), measures, THRESHOLDS))


if __name__ == "__main__":
    main()
