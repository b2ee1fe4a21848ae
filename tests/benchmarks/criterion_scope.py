"""Share of left-out ground motions under which a criterion really holds: regions, magnitudes and lengths.

    python tests/benchmarks/criterion_scope.py RECORDS [GROUP...]

For each group of the 100 records the criterion is learned from all others: as recorded, protected over
lengths (the default), carried to the length of each record, and carried to the structure's response under
it; the error of the loop is then computed along the whole edge. Printed are the shares kept at the stated
50, 80, 90, 95 and 99 %, and the median area at 95 % over that of the criterion as recorded. At the end all
groups of a kind stand together, and each class among motions that were left out by their earthquake alone.
GROUP is the beginning of a group's name, such as "length" or "region Taiwan".
"""

import sys
from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pandas as pd

from reliab.core.shipped import shipped
from reliab.core.vocabulary import Side
from reliab.criterion.carrying import carry_to_length, carry_to_response, protect_over_lengths
from reliab.criterion.derivation import Derivation
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.criterion.ellipse_table import as_table
from reliab.criterion.methods.registry import method_of
from reliab.criterion.response_measures import read_shipped_ellipses
from reliab.motions.loading import load_motions
from reliab.sweep.netcdf import read_netcdf
from reliab.validation.truth import Cell, Region, SimulatedTruth

THRESHOLD = 0.05
CONFIDENCES = (0.5, 0.8, 0.9, 0.95, 0.99)
F, XI = (0.5, 1.0, 2.0), (0.02, 0.05)
STRUCTURES = tuple(product(F, XI))
MAGNITUDES = (6.4, 6.6, 7.0, 7.3, 8.0)
LENGTHS = (0.0, 25.0, 34.0, 45.0, 200.0)


def groups_of(ellipses):
    """Motions of each region, class of magnitude and class of length."""
    table = pd.read_csv(shipped("datasets", "real_suite/earthquakes.csv")).set_index("event")
    events, lengths = ellipses["event"].values.astype(str), ellipses["duration"].values
    regions, magnitudes = (table.loc[events, name].to_numpy() for name in ("region", "magnitude"))
    groups = {f"region {region}": regions == region for region in np.unique(regions)}
    for name, values, edges in (("magnitude", magnitudes, MAGNITUDES), ("length", lengths, LENGTHS)):
        for low, high in pairwise(edges):
            groups[f"{name} {low:g} to {high:g}"] = (values > low) & (values <= high)
    return groups


def limits_of(ellipses, side="lag", *, threshold=THRESHOLD, structures=STRUCTURES):
    """Limits a and b of ellipses as they are, no length protected, over (confidence, structure, 2)."""
    table = replace(as_table(ellipses), cut_records=None)
    derivation = Derivation.from_ellipses(
        table, method=method_of("dirichlet"), threshold=threshold, metric="rms"
    )
    criteria = [derivation.criterion(confidence, joint=True) for confidence in CONFIDENCES]
    return np.array(
        [[criterion.limits(f, xi, side) for f, xi in structures] for criterion in criteria], float
    )


def errors_on_edges(truth, motion, f, xi, limits, *, threshold=THRESHOLD, side="lag"):
    """Largest error over the threshold on the edge of each region; `limits` (regions, 2)."""
    edges = [Region(a=a, b=b, side=Side(side)).edge() for a, b in limits.tolist()]
    gain, delay = (np.concatenate([getattr(edge, name) for edge in edges]) for name in ("gain", "delay"))
    cell = Cell(frequency=f, damping_ratio=xi, threshold=threshold, metric="rms")
    return truth.errors(cell, motion, gain, delay).reshape(len(limits), -1).max(axis=1)


def are_kept(truth, motion, limits):
    """Whether the error stays below the threshold along the whole edge, over (confidence, structure)."""
    errors = [
        errors_on_edges(truth, motion, f, xi, limits[:, place]) for place, (f, xi) in enumerate(STRUCTURES)
    ]
    return np.array(errors).T <= 1.0


def read_inscribed(thresholds):
    """Inscribed ellipses that ship, of the structures at some thresholds."""
    table = read_shipped_ellipses("inscribed", "record", "rms")
    near = {"f": F, "xi": XI, "threshold": thresholds}
    return table.take(
        **{
            name: [int(np.abs(table.coordinates[name] - value).argmin()) for value in values]
            for name, values in near.items()
        }
    )


def judge(ellipses, measures, truth, left_out_motions):
    """Shares kept by the four criteria (motions, criteria, confidences), and areas (motions, criteria)."""
    learning, learning_measures = (
        ellipses.isel(motion=~left_out_motions),
        measures.isel(motion=~left_out_motions),
    )
    plain, protection = limits_of(learning), limits_of(protect_over_lengths(learning))
    shares_kept, areas = [], []
    for motion in np.flatnonzero(left_out_motions):
        limits_for_length = limits_of(carry_to_length(learning, float(ellipses["duration"][motion])))
        limits_for_response = limits_of(
            carry_to_response(learning, learning_measures, measures.isel(motion=[motion]))
        )
        criteria = plain, protection, limits_for_length, limits_for_response
        shares_kept.append([are_kept(truth, motion, limits).mean(axis=-1) for limits in criteria])
        areas.append([np.median(np.sqrt((limits / plain)[-2].prod(axis=-1))) for limits in criteria])
    return np.array(shares_kept), np.array(areas)


def show(name, events, shares_kept, areas):
    """Print one line."""
    shares = "  ".join(" ".join(f"{100 * share:3.0f}" for share in row) for row in shares_kept.mean(axis=0))
    area = " ".join(f"{part:.2f}" for part in np.median(areas, axis=0)[1:])
    print(f"{name:24s} {len(shares_kept):7d} {np.unique(events).size:11d}  {shares}  {area}", flush=True)


def main():
    structures = {"f": list(F), "xi": list(XI)}
    ellipses = read_ellipses("real_suite").sel(
        metric=["rms"], threshold=[THRESHOLD], side=["lag"], curve=["inscribed"], **structures
    )
    measures = read_netcdf(shipped("datasets", "real_suite/first_order.nc"), "Measures", "").sel(structures)
    suite = load_motions(sys.argv[1], sets=["far_field", "near_field"])
    places = {name: place for place, name in enumerate(suite.names)}
    truth = SimulatedTruth(motions=[suite[places[str(name)]] for name in ellipses["motion"].values])
    events = ellipses["event"].values.astype(str)
    groups = groups_of(ellipses)
    selection = [name for name in groups if any(name.startswith(start) for start in sys.argv[2:] or [""])]
    heads = "as recorded          protected            by length            by response          areas"
    print(f"{'left out':24s} motions earthquakes  {heads}")
    parts_of_kind = {}
    for name in selection:
        shares_kept, areas = judge(ellipses, measures, truth, groups[name])
        show(name, events[groups[name]], shares_kept, areas)
        parts_of_kind.setdefault(name.split()[0], []).append((events[groups[name]], shares_kept, areas))
    for kind, parts in parts_of_kind.items():
        show(f"every {kind}", *(np.concatenate(part) for part in zip(*parts, strict=True)))
    if len(sys.argv) == 2:
        show_alone(ellipses, measures, truth, groups)


def show_alone(ellipses, measures, truth, groups):
    """Print each class among motions that were left out by their earthquake alone."""
    events = ellipses["event"].values.astype(str)
    shares_kept, areas = np.empty((events.size, 4, len(CONFIDENCES))), np.empty((events.size, 4))
    for event in np.unique(events):
        shares_kept[events == event], areas[events == event] = judge(
            ellipses, measures, truth, events == event
        )
    show("every earthquake", events, shares_kept, areas)
    for name, members in groups.items():
        show(f"  {name}", events[members], shares_kept[members], areas[members])


if __name__ == "__main__":
    main()
