"""Ellipses carried to another response, length or suite, on populations whose law is known."""

import numpy as np
import pytest
import xarray as xr

from reliab.core.errors import InputError
from reliab.criterion.carrying import carry_to_length, carry_to_response, carry_to_suite
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.laws.law import scales

F, XI, THRESHOLD = np.array([0.5, 1.0, 2.0]), np.array([0.02, 0.05]), 0.05
EVENTS, OF_EVENT = 40, 3


def population(rng, *, scatter=0.1, event_variance=0.05, duration=None, events=EVENTS):
    """A population with a = ε² a_first·e^r: r scatters between earthquakes and between motions."""
    count = events * OF_EVENT
    event = np.repeat([f"E{number}" for number in range(events)], OF_EVENT)
    duration = np.exp(rng.uniform(np.log(10.0), np.log(100.0), count)) if duration is None else duration
    effective = duration[:, None, None] * np.exp(rng.normal(-2.0, 0.5, (count, 1, 1)))
    measures = {}
    for name, scale in zip(("a", "b"), scales(F[:, None], XI[None, :]), strict=True):
        measures[f"{name}_first"] = (("motion", "f", "xi"), 8.0 * scale * duration[:, None, None] / effective)
    shared = np.repeat(rng.normal(0.0, event_variance, events), OF_EVENT)
    residuals = shared + rng.normal(-0.2, scatter, count)
    coordinates = {
        "motion": [f"{name}/{number}" for number, name in enumerate(event)],
        "event": ("motion", event),
        "duration": ("motion", duration),
        "f": F,
        "xi": XI,
    }
    reference = xr.Dataset(
        {**measures, "effective_duration": (("motion", "f", "xi"), effective * np.ones((1, 3, 2)))},
        coords=coordinates,
    )
    ellipses = xr.Dataset(
        {
            name: THRESHOLD**2 * reference[f"{name}_first"] * np.exp(residuals)[:, None, None]
            for name in ("a", "b")
        }
    )
    ellipses = ellipses.expand_dims(
        {"threshold": [THRESHOLD], "metric": ["rms"], "curve": ["inscribed"], "side": ["lag"]},
        axis=[3, 4, 5, 6],
    )
    return ellipses.assign_attrs(window="record", experimental_fraction=1.0), reference


def count_share(limits, verdict):
    a, b = limits
    cell = verdict.sel(f=1.0, xi=0.02).squeeze()
    return np.mean((cell["a"].values >= a) & (cell["b"].values >= b))


@pytest.fixture(scope="module")
def shares_after_carrying():
    """Shares kept of further motions by criteria carried to each one's response, and by one as it is."""
    rng = np.random.default_rng(5)
    ellipses, reference = population(rng)
    rivals, other_measures = population(rng, events=20)
    shares = []
    for place in range(rivals.sizes["motion"]):
        carried = carry_to_response(
            ellipses, reference, other_measures.isel(motion=[place]).sel(f=[1.0], xi=[0.02])
        )
        limits = derive_criterion(carried, confidence=0.9).limits(1.0, 0.02)
        shares.append((count_share(limits, rivals.isel(motion=[place])), limits[0]))
    plain_criterion = derive_criterion(ellipses.sel(f=[1.0], xi=[0.02]), confidence=0.9).limits(1.0, 0.02)
    return np.array(shares), count_share(plain_criterion, rivals), plain_criterion[0]


@pytest.mark.slow
def test_a_criterion_carried_to_a_response_keeps_its_share(shares_after_carrying):
    shares, _, _ = shares_after_carrying
    assert shares[:, 0].mean() == pytest.approx(0.9, abs=0.09)  # 60 motions of 20 earthquakes: 2 sd


@pytest.mark.slow
def test_a_criterion_carried_to_a_response_allows_more_in_the_median(shares_after_carrying):
    shares, _, plain_criterion = shares_after_carrying
    assert np.median(shares[:, 1]) > 1.5 * plain_criterion


def test_a_population_carried_to_its_own_first_order_has_only_its_residual():
    ellipses, reference = population(np.random.default_rng(1), scatter=0.1, event_variance=0.0)
    carried = carry_to_response(ellipses, reference, reference.isel(motion=[7]).sel(f=[1.0], xi=[0.05]))
    assert float(np.log(carried["a"]).std()) == pytest.approx(0.1, rel=0.2)
    assert float(np.log(ellipses["a"].sel(f=1.0, xi=0.05)).std()) > 0.4


def test_means_of_populations_are_expected_to_differ():
    """By a variance of a fifth of that of motions."""
    ellipses, reference = population(np.random.default_rng(11), scatter=0.1, event_variance=0.0, events=200)
    carried = carry_to_response(ellipses, reference, reference.isel(motion=[7]).sel(f=[1.0], xi=[0.05]))
    all_values = np.log(ellipses["a"].squeeze(drop=True) / (THRESHOLD**2 * reference["a_first"]))
    multiples = all_values.sel(f=1.0, xi=0.05)
    assert float(np.log(carried["a"]).std() / multiples.std()) == pytest.approx(1.2**0.5, rel=0.03)


@pytest.mark.parametrize(("share", "promise"), [(0.5, None), (0.79, None), (0.8, 0.8), (0.95, 0.95)])
def test_response_promises_only_achievable_shares(share, promise):
    ellipses, reference = population(np.random.default_rng(12))
    typical = reference.isel(motion=[int(reference["a_first"][:, 1, 0].argsort()[60])]).sel(
        f=[1.0], xi=[0.02]
    )
    criterion = derive_criterion(carry_to_response(ellipses, reference, typical), confidence=share)
    assert criterion.promise == promise
    message = any("No share below 80 % is promised" in sentence for sentence in criterion.provenance.warnings)
    assert message == (promise is None)


LENGTHS = np.array([10.0, 20.0, 40.0, 80.0])


def add_quiet_ends(ellipses):
    """Records that only lose quiet time when they are cut: a and b shrink with their length."""
    complete = ellipses["duration"].values[:, None]
    ratios = np.minimum(LENGTHS / complete, 1.0)[:, None, None, :] * np.ones((1, F.size, XI.size, 1))
    dimensions = ("motion", "f", "xi", "length")
    return ellipses.assign(dict.fromkeys(("a_cut", "b_cut"), (dimensions, ratios))).assign_coords(
        length=LENGTHS
    )


def test_each_motion_is_carried_to_a_length_by_its_own_record():
    ellipses = add_quiet_ends(population(np.random.default_rng(2))[0])
    for length in (*LENGTHS, 28.3):
        carried = carry_to_length(ellipses, float(length))
        shares = np.minimum(length / ellipses["duration"], 1.0)
        for name in ("a", "b"):
            expected = (ellipses[name] * shares).transpose(*ellipses[name].dims)
            # Between two lengths a record that ends there is interpolated, not cut.
            np.testing.assert_allclose(carried[name], expected, rtol=1e-9 if length in LENGTHS else 0.2)


def test_near_fault_short_records_do_not_set_short_limits():
    """In a suite whose short records shake briefly a regression over lengths would find no dependence."""
    rng = np.random.default_rng(7)
    ellipses = add_quiet_ends(population(rng)[0])
    biased_sample = ellipses.assign({name: 0.0 * ellipses[name] + 1e-4 for name in ("a", "b")})
    medians = [float(carry_to_length(biased_sample, length)["a"].median()) for length in (10.0, 80.0)]
    assert medians[1] / medians[0] > 2.0


def test_other_errors_do_not_depend_on_the_length():
    ellipses = add_quiet_ends(population(np.random.default_rng(2))[0]).assign_coords(metric=["mte"])
    np.testing.assert_array_equal(carry_to_length(ellipses, 10.0)["a"], ellipses["a"])


def test_length_needs_records_to_cut():
    with pytest.raises(InputError, match="cannot be transferred to a length of record"):
        carry_to_length(population(np.random.default_rng(2))[0], 20.0)


def test_a_length_outside_of_the_population_promises_nothing():
    carried = carry_to_length(add_quiet_ends(population(np.random.default_rng(3))[0]), 5.0)
    assert carried.attrs["position"] == "outside"
    assert "The criterion promises nothing" in carried.attrs["caution"]


def test_a_suite_moves_the_population_part_of_the_way():
    rng = np.random.default_rng(6)
    ellipses = add_quiet_ends(population(rng, event_variance=0.3)[0])
    original = ellipses.isel(motion=slice(0, 12)).assign(
        {name: ellipses[name].isel(motion=slice(0, 12)) * 3.0 for name in ("a", "b")}
    )
    carried = carry_to_suite(
        ellipses, original.assign_coords(duration=("motion", original["duration"].values))
    )
    means = [
        float(np.log(part["a"].sel(f=1.0, xi=0.02)).mean())
        for part in (
            carry_to_length(ellipses, float(np.exp(np.log(original["duration"]).mean()))),
            carried,
            original,
        )
    ]
    assert means[0] < means[1] < means[2]


def test_another_error_than_rms_is_refused():
    ellipses, reference = population(np.random.default_rng(8), events=2)
    with pytest.raises(InputError, match="RMS error only"):
        carry_to_response(ellipses.assign_coords(metric=["mte"]), reference, reference.isel(motion=[0]))


@pytest.mark.parametrize("duration", [0.0, -3.0, np.inf])
def test_a_length_must_be_positive_and_finite(duration):
    with pytest.raises(InputError, match=r"must be (positive|finite)"):
        carry_to_length(add_quiet_ends(population(np.random.default_rng(9), events=2)[0]), duration)


@pytest.mark.parametrize(
    ("change", "labels"),
    [
        ({"a_first": 0.1, "b_first": 0.1}, "error that an amplitude error"),
        ({"a_first": 4.0}, "error's frequency"),
    ],
)
def test_a_response_unlike_those_of_the_population_is_outside(change, labels):
    """Off resonance, and far more demanding than any motion of the population."""
    ellipses, reference = population(np.random.default_rng(21))
    typical = reference.isel(motion=[int(reference["a_first"][:, 1, 0].argsort()[60])]).sel(
        f=[1.0], xi=[0.02]
    )
    assert carry_to_response(ellipses, reference, typical).attrs["position"] != "outside"
    variant = typical.assign({name: typical[name] * factor for name, factor in change.items()})
    carried = carry_to_response(ellipses, reference, variant)
    assert carried.attrs["position"] == "outside"
    assert labels in carried.attrs["caution"]
    assert "promises nothing" in carried.attrs["caution"]


def test_shipped_earthquakes_report_shares_of_other_motions():
    ellipses, reference = population(np.random.default_rng(21))
    typical = reference.isel(motion=[int(reference["a_first"][:, 1, 0].argsort()[60])]).sel(
        f=[1.0], xi=[0.02]
    )
    shipped = np.resize(["NORTHR", "DUZCE", "HECTOR"], EVENTS)
    labels = ellipses.assign_coords(event=("motion", np.repeat(shipped, OF_EVENT)))
    assert (
        "Of simulated motions of other kinds"
        in carry_to_response(labels, reference, typical).attrs["caution"]
    )
    assert "soft soil" not in carry_to_response(ellipses, reference, typical).attrs["caution"]
    assert "cut" in carry_to_length(add_quiet_ends(labels), 40.0).attrs["caution"]
    assert carry_to_length(add_quiet_ends(ellipses), 40.0).attrs["caution"] == ""
