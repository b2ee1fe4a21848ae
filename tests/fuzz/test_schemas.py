"""Each format is checked once, at the door: whatever stands in a place of it, a result or one clear error."""

import contextlib
import itertools

import numpy as np
import pytest
import scipy
from scipy.io import savemat

from fuzz import corpus
from fuzz.corpus import CHAIN_MODEL, CHAIN_SETTINGS
from fuzz.damage import write
from fuzz.test_described_files import VALUES, places, replace_value
from reliab.core.errors import InputError
from reliab.criterion.derivation import derive_criterion
from reliab.recordings.readers.registry import read_tests
from reliab.sampling.ensembles import draw
from reliab.simulation.frames.transfer_table import read_matlab
from reliab.simulation.transfer_systems.transfer_function import TransferFunction
from reliab.sweep.ellipse_dataset import open_ellipses
from reliab.sweep.netcdf import write_netcdf
from reliab.sweep.results import open_results

PLANTS = (
    {"num": [1.0, 2.0], "den": [1.0, 3.0, 4.0]},
    {"z": [-1.0], "p": [-2.0, -3.0], "k": 2.0},
    {"A": [[-1.0, 0.0], [0.0, -2.0]], "B": [[1.0], [1.0]], "C": [[1.0, 1.0]], "D": 0.0},
)
CONTENTS = (
    *(1.0, 0.0, -1.0, 1e308, 1e-320, np.nan, np.inf, 1j, "text", True, np.uint8(3)),
    *([], [0.0, 0.0], [1.0, 2j], [-1 + 1j, -1 - 1j], [-1 + 1j], ["a", "bc"], {"x": 1.0}),
    *(
        np.zeros((2, 0)),
        np.arange(27.0).reshape(3, 3, 3),
        np.array([1.0, "a"], dtype=object),
        scipy.sparse.eye(2),
    ),
)


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.default_cases(2)
@pytest.mark.parametrize("plant", PLANTS, ids=["coefficients", "roots", "state space"])
@pytest.mark.parametrize("structure", [None, "model"])
def test_any_two_variables_of_a_plant_may_be_anything(tmp_path, plant, structure):
    path = tmp_path / "plant.mat"
    pairs = list(itertools.combinations(plant, 2))
    for number, (first_content, two) in enumerate(itertools.product(CONTENTS, CONTENTS)):
        first, second = pairs[number % len(pairs)]
        variables = {**plant, first: first_content, second: two}
        savemat(path, variables if structure is None else {structure: variables})
        with contextlib.suppress(InputError):
            system = read_matlab(path, structure)
            assert isinstance(system, TransferFunction)
            assert np.isfinite([*system.numerator, *system.denominator]).all()


@pytest.mark.parametrize(
    ("plant", "name"), [(plant, name) for plant in PLANTS for name in plant if name not in "zp"]
)
def test_imaginary_parts_of_a_plant_are_not_dropped(tmp_path, plant, name):
    savemat(tmp_path / "plant.mat", {**plant, name: np.asarray(plant[name]) + 1e-9j})
    with pytest.raises(InputError, match=f"The variable {name} of a transfer system must be real numbers"):
        read_matlab(tmp_path / "plant.mat")


CHANGES = {
    "no event": lambda data: data.drop_vars("event"),
    "event of numbers": lambda data: data.assign_coords(event=("motion", np.arange(30.0))),
    "event over another axis": lambda data: data.assign_coords(event=("f", ["a", "b"])),
    "a share that is text": lambda data: data.assign_attrs(experimental_fraction="half"),
    "a share beyond one": lambda data: data.assign_attrs(experimental_fraction=1.5),
    "several shares": lambda data: data.assign_attrs(experimental_fraction=[0.5, 1.0]),
    "an additional axis": lambda data: data.expand_dims("place"),
    "an additional axis of a": lambda data: data.assign(a=data["a"].expand_dims(place=2)),
    "text as parameters": lambda data: data.assign(a=data["a"].astype(str)),
    "frequencies that are text": lambda data: data.assign_coords(f=["slow", "fast"]),
    "negative frequencies": lambda data: data.assign_coords(f=[-1.0, 1.0]),
    "one frequency twice": lambda data: data.assign_coords(f=[1.0, 1.0]),
    "no frequencies": lambda data: data.drop_vars("f"),
    "thresholds that are not finite": lambda data: data.assign_coords(threshold=[np.inf]),
    "metrics that are numbers": lambda data: data.assign_coords(metric=[1.0]),
    **{
        f"nothing along {name}": lambda data, name=name: data.isel({name: slice(0, 0)})
        for name in ("motion", "f", "xi", "threshold", "metric", "curve", "side")
    },
}


@pytest.mark.slow
@pytest.mark.default_cases(6)
@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_ellipses_of_another_schema_are_refused_when_they_are_opened(tmp_path, change):
    write_netcdf(change(corpus.ellipse_dataset().copy(deep=True)), tmp_path / "ellipses.nc")
    with pytest.raises(InputError, match="Ellipses in NetCDF are a and b over motion"):
        open_ellipses(tmp_path / "ellipses.nc")


def test_ellipses_of_the_schema_are_opened_and_lead_to_a_criterion(tmp_path):
    write_netcdf(corpus.ellipse_dataset(), tmp_path / "ellipses.nc")
    assert derive_criterion(open_ellipses(tmp_path / "ellipses.nc"), method="quantile", confidence=0.8)


DESCRIBED = ("A", "checksum", "d", "dt", "duration", "event", "f", "journal", "journal/entries", "kp")
DESCRIBED += ("motion", "mte", "pga", "rms", "rms_at_rest", "stable", "tau", "xi", "")


def test_every_description_in_a_store_is_tried():
    names = {name for name in corpus.stores()[0] if name.endswith("zarr.json")}
    assert names == {f"results.zarr/{array}/zarr.json".replace("//", "/") for array in DESCRIBED}


@pytest.mark.slow
@pytest.mark.parametrize("array", DESCRIBED)
def test_every_value_of_a_description_in_a_store_may_be_anything(tmp_path, array):
    import json

    case, name = corpus.stores()[0], f"results.zarr/{array}/zarr.json".replace("//", "/")
    description = json.loads(case[name])
    for number, (place, value) in enumerate(itertools.product(places(description), VALUES)):
        folder = tmp_path / str(number)
        write({**case, name: json.dumps(replace_value(description, place, value)).encode()}, folder)
        with contextlib.suppress(InputError):
            open_results(folder / "results.zarr").reliab.ellipses()


@pytest.mark.parametrize("dimensions", [[None], [""], ["f", "motion", "xi"], ["motion", "f", "kp"]])
def test_errors_at_rest_over_other_dimensions_are_refused(tmp_path, dimensions):
    import json

    case, name = corpus.stores()[0], "results.zarr/rms_at_rest/zarr.json"
    description = json.loads(case[name])
    description["dimension_names"] = [*dimensions, *description["dimension_names"][len(dimensions) :]]
    write({**case, name: json.dumps(description).encode()}, tmp_path)
    with pytest.raises(InputError, match="must be as `reliab simulate` wrote them"):
        open_results(tmp_path / "results.zarr")


@pytest.mark.parametrize(
    "read",
    [read_tests, open_ellipses, lambda path: draw(CHAIN_MODEL, CHAIN_SETTINGS, file=path, group="run")],
    ids=["test", "ellipses", "chains"],
)
def test_groups_deep_within_each_other_are_refused(tmp_path, read):
    import h5py

    with h5py.File(tmp_path / "deep.h5", "w") as file:
        group = file
        for _ in range(100):
            group = group.create_group("group")
        group["a"] = group["b"] = np.arange(99.0)
    with pytest.raises(InputError, match="are nested more than 32 deep"):
        read(tmp_path / "deep.h5")
