"""Criteria of real motions judged on simulated earthquakes and the reverse; and of ten own records.

    python tests/benchmarks/simulated_populations.py FOLDER [--motions 100] [--sets 200] [--seed 3435]

Populations are simulated by Dabaghi and Der Kiureghian (2018), within the range of the model: like the real
suite, small earthquakes, large ones far away, pulses, soft soil. Subduction earthquakes lie outside of it. A
criterion keeps its promise under a motion where its region lies within the motion's ellipse, at 5 % RMS^R, 1
Hz and 2 and 5 % damping. All ellipses, also those that are learned from, are predicted for small errors:
milliseconds where tracing takes seconds; a traced a is 5 % smaller, on either side alike.

Printed are shares kept at the stated 50, 80, 90, 95 and 99 %: of criteria as recorded, protected over lengths
(the default) and carried to the length of each record; learned from the real motions and judged on each
simulated population, then the reverse. Then ten records, whole earthquakes, are drawn from each population,
pooled with the real one (`reliab criterion --suite`), and judged on the population's other earthquakes.
Real groups stand among the populations; their earthquakes are then left out of the real one.
FOLDER keeps the responses, so that a second run begins with them.
"""

from dataclasses import replace
from functools import partial
from itertools import count, product
from math import pi

import numpy as np
import xarray as xr
from benchmark_script import argument_parser
from criterion_scope import THRESHOLD, groups_of, limits_of as limits_at

from reliab.core.shipped import shipped
from reliab.criterion.carrying import carry_to_length, carry_to_suite, protect_over_lengths
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import physical_parameters, regression_of
from reliab.motions.synthetic.fema_p695_2009 import draw_earthquake, draw_scenario
from reliab.motions.synthetic.recording import TIME_STEP, RandomStream
from reliab.motions.synthetic.suite import _record
from reliab.sweep.cut_records import add_known_cut_records, measure_cut_records
from reliab.sweep.ellipse_table import measure_responses
from reliab.sweep.netcdf import read_netcdf

SEED = 3435
POPULATIONS = {
    "simulated like the suite": {},
    "simulated small": {"magnitude": (5.6, 6.3), "rupture_distance": (8.0, 30.0)},
    "simulated large and far": {"magnitude": (7.5, 7.9), "rupture_distance": (20.0, 31.0)},
    "simulated pulses": {"magnitude": (6.5, 7.5), "rupture_distance": (1.0, 8.0), "pulse_like": True},
    "simulated soft soil": {"magnitude": (6.4, 7.2), "shear_wave_velocity": (145.0, 220.0)},
}
TEN = 10
CUT = 3.0  # standard deviations of the model's errors
XI, F = (0.02, 0.05), (1.0,)


def simulate_earthquake(name, number, seed=SEED):
    """Two components of an earthquake of a population."""
    ranges = dict(POPULATIONS[name])
    place = list(POPULATIONS).index(name)
    random = np.random.default_rng([seed, place, number])
    streams = partial(RandomStream, seed + place, number)
    pulse_like = ranges.pop("pulse_like", False)
    for attempt in count():
        scenario = draw_scenario(draw_earthquake(streams(attempt, 1)), streams(attempt, 2))
        values = {key: float(random.uniform(*ends)) for key, ends in ranges.items()}
        values["depth_to_top"] = min(scenario.depth_to_top, values.get("rupture_distance", np.inf))
        scenario = replace(scenario, **values)
        regression = regression_of(pulse_like=pulse_like)
        standard = regression.factor @ random.normal(size=regression.deviations.size)
        transformed_values = regression.means(scenario) + standard * regression.deviations
        parameters = physical_parameters(transformed_values, pulse_like=pulse_like)
        if np.abs(standard).max() < CUT and (parameters.pulse is None or parameters.pulse.start >= 0.0):
            break
    noises = streams(0, 3), streams(0, 4)
    components = _record(parameters, scenario.magnitude, noises, random.uniform(0.0, 2.0 * pi))
    return [
        Motion(
            name=f"{name}/{number}/{axis}",
            acceleration=component,
            time_step=TIME_STEP,
            event=f"{name} {number}",
            set_name="simulated",
        )
        for axis, component in enumerate(components, 1)
    ]


def population(name, motions, folder, seed):
    """Ellipses of a simulated population, in the limit of small errors."""
    path = folder / f"{name.replace(' ', '_')}_{motions}_{seed}.nc"
    if not path.is_file():
        numbers = range(1, motions // 2 + 1)
        suite = [motion for number in numbers for motion in simulate_earthquake(name, number, seed)]
        motions_of_suite = MotionSuite.from_motions(suite)
        cut_records = measure_cut_records(motions_of_suite, F, XI, 1.0)
        measured = measure_responses(motions_of_suite, F, XI).merge(cut_records)
        measured.to_netcdf(path, engine="h5netcdf")
    measures = xr.load_dataset(path, engine="h5netcdf")
    lengths, responses = (
        measures[name_of_measure].quantile([0.0, 0.5, 1.0]).values
        for name_of_measure in ("duration", "effective_duration")
    )
    print(f"{name:28s} lengths {lengths.round(0)} s, effective durations {responses.round(1)} s", flush=True)
    return predict_ellipses(measures)


def predict_ellipses(measures):
    """Ellipses at the threshold as predicted for small errors."""
    single = {"threshold": [THRESHOLD], "metric": ["rms"], "curve": ["inscribed"], "side": ["lag"]}
    ellipses = xr.Dataset({name: THRESHOLD**2 * measures[f"{name}_first"] for name in "ab"})
    ellipses = ellipses.expand_dims(single, axis=list(range(3, 7)))
    ellipses = ellipses.assign_attrs(window="record", experimental_fraction=1.0)
    if "a_cut" in measures:
        return ellipses.assign({name: measures[name] for name in ("a_cut", "b_cut")})
    return add_known_cut_records(ellipses)


def limits_of(ellipses):
    """Limits a and b over (confidence, damping ratio, 2)."""
    return limits_at(ellipses, structures=tuple(product(F, XI)))


def shares_kept(limits, target):
    """Whether the region lies within a motion's inscribed ellipse, over (motion, confidence)."""
    single = {name: 0 for name in target["a"].dims if name not in {"motion", "xi"}}
    a, b = (target[name].isel(single).transpose("motion", "xi").values[:, None] for name in "ab")
    is_within = (limits[None, ..., 0] <= a) & (limits[None, ..., 1] <= b)
    return (is_within & np.isfinite(a)).mean(axis=-1)


def compare_criteria(source, target):
    """Shares kept by criteria as recorded, protected, and carried to the length of each record."""
    lengths = target["duration"].values
    lengths = np.maximum(5.0 * np.round(lengths / 5.0), 5.0)
    limits_by_length = {
        length: limits_of(carry_to_length(source, float(length))) for length in np.unique(lengths)
    }
    kept_by_length = [
        shares_kept(limits_by_length[length], target.isel(motion=[place]))[0]
        for place, length in enumerate(lengths)
    ]
    plain, protected_limits = limits_of(source), limits_of(protect_over_lengths(source))
    return [
        shares_kept(plain, target).mean(0),
        shares_kept(protected_limits, target).mean(0),
        np.mean(kept_by_length, axis=0),
    ]


def pool_ten_records(source, target, random):
    """Share that a criterion pooled with ten records of a population keeps on its other earthquakes."""
    own_records = []
    for event in random.permutation(np.unique(target["event"].values)):
        own_records += np.flatnonzero(target["event"].values == event).tolist()
        if len(own_records) >= TEN:
            break
    other_records = np.setdiff1d(np.arange(target.sizes["motion"]), own_records)
    limits = limits_of(carry_to_suite(source, target.isel(motion=own_records[:TEN])))
    return shares_kept(limits, target.isel(motion=other_records)).mean(0)


def line(name, shares):
    text = "   ".join(" ".join(f"{100 * share:3.0f}" for share in part) for part in shares)
    print(f"{name:44s} {text}", flush=True)


def main():
    options = argument_parser(__doc__, "folder", motions=100, sets=200, seed=SEED).parse_args()
    options.folder.mkdir(exist_ok=True)
    measures = read_netcdf(shipped("datasets", "real_suite/first_order.nc"), "Measures", "")
    real = predict_ellipses(measures.sel(f=list(F), xi=list(XI)))
    targets = {
        name: (population(name, options.motions, options.folder, options.seed), real) for name in POPULATIONS
    }
    print("learned from / judged on                     as recorded, protected over lengths, by length")
    for name, (target, _) in targets.items():
        line(f"real / {name}", compare_criteria(real, target))
    for name, (source, _) in targets.items():
        line(f"{name} / real", compare_criteria(source, real))
    for name, members in groups_of(real).items():
        group, complement = real.isel(motion=members), real.isel(motion=~members)
        is_independent = ~np.isin(complement["event"].values, group["event"].values)
        if np.unique(group["event"].values).size >= TEN // 2 and group.sizes["motion"] >= 3 * TEN:
            targets[f"real, {name}"] = group, complement.isel(motion=is_independent)
    print("ten own records pooled with the real population, judged on other earthquakes of their kind")
    random, shares_of_sets = np.random.default_rng(options.seed), []
    for place, (name, (target, source)) in enumerate(targets.items()):
        sets = range(options.sets // len(targets) + (place < options.sets % len(targets)))
        shares = [pool_ten_records(source, target, random) for _ in sets]
        shares_of_sets += shares
        line(f"{name} ({len(shares)} sets)", [np.mean(shares, axis=0), np.std(shares, axis=0)])
    line(
        f"all ({len(shares_of_sets)} sets)", [np.mean(shares_of_sets, axis=0), np.std(shares_of_sets, axis=0)]
    )


if __name__ == "__main__":
    main()
