"""What the package offers to Python mirrors the command line."""

import json
import subprocess
import sys
from dataclasses import replace

import h5py
import numpy as np
import pandas as pd
import pytest
import xarray as xr

import reliab
from reliab.app import cli
from reliab.app.api.channels import FileReading
from reliab.app.api.criteria import derive_criteria
from reliab.app.api.simulation import list_motions, trace_boundaries
from reliab.core.shipped import shipped
from reliab.motions.catalogue import write_suite
from reliab.motions.suite import MotionSuite

PUBLIC_NAMES = (
    *("load_motions", "simulate", "ellipses", "derive_criterion"),
    *("assess", "design_test", "cross_validate", "diagnose", "write_report"),
)


@pytest.mark.parametrize("name", [name for name in reliab.__all__ if name != "__version__"])  # type: ignore[attr-defined]
def test_every_name_is_a_documented_function(name):
    function = getattr(reliab, name)
    assert callable(function)
    assert function.__doc__
    assert name in dir(reliab)


def test_one_thing_has_one_name():
    twins = {"derive_criteria", "trace_boundaries", "diagnose_campaign", "simulate_suite", "report_run"}
    assert twins.isdisjoint(reliab.__all__)  # type: ignore[attr-defined]


def test_the_names_of_the_design_are_there():
    assert set(PUBLIC_NAMES) <= set(reliab.__all__)  # type: ignore[attr-defined]


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="magic"):
        reliab.magic  # type: ignore[attr-defined]  # noqa: B018


def test_importing_the_package_imports_no_numerics():
    code = "import sys, reliab; print('numpy' in sys.modules)"
    process = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)  # noqa: S603
    assert process.stdout.strip() == "False"


@pytest.mark.slow
def test_a_test_is_judged_from_a_name_and_numbers():
    first = reliab.assess("sample_test", f="1±0.01", xi=0.02)
    assert first.stated["f"].deviation == 0.01
    second = reliab.assess(first.recording, reliab.Structure(frequency=1.0, damping_ratio=0.02))
    assert second.to_dict() == reliab.assess("sample_test", f=1.0, xi=0.02).to_dict()


@pytest.mark.parametrize(
    "statements",
    [{}, {"f": "one", "xi": 0.02}, {"f": 1.0, "xi": 0.02, "criterion": "missing.json"}],
)
def test_a_missing_structure_is_refused(statements):
    with pytest.raises(reliab.InputError):
        reliab.assess("sample_test", **statements)


def test_a_structure_stated_twice_is_refused():
    structure = reliab.Structure(frequency=1.0, damping_ratio=0.02)
    with pytest.raises(reliab.InputError, match="`f` has no effect together with `structure`"):
        reliab.assess("sample_test", structure, f=1.0)


@pytest.fixture(scope="module")
def motion():
    return replace(reliab.load_motions("synthetic")[0], name="one")


@pytest.fixture(scope="module")
def traced_ellipses(motion):
    return reliab.ellipses(motion, f=[1.0], xi=[0.02], threshold=[0.05], metric=["rms"])


def test_one_number_or_name_means_the_same_as_a_list_of_it(motion, traced_ellipses):
    for as_sequence in (float, np.float64, lambda value: np.array([value])):
        single = reliab.ellipses(
            motion, f=as_sequence(1.0), xi=as_sequence(0.02), threshold=as_sequence(0.05), metric="rms"
        )
        xr.testing.assert_identical(single, traced_ellipses)


def test_files_of_commands_are_taken_everywhere(motion, traced_ellipses, tmp_path):
    store, records = tmp_path / "results.zarr", tmp_path / "records"
    results = reliab.simulate(motion, out=store, f=1.0, xi=0.02, window="record")
    stored_ellipses = reliab.ellipses(store)
    xr.testing.assert_identical(stored_ellipses, reliab.ellipses(results))
    np.testing.assert_allclose(stored_ellipses["b"], traced_ellipses["b"], rtol=0.02)
    xr.testing.assert_identical(reliab.read_ellipses(store)["a"], stored_ellipses["a"])
    write_suite(MotionSuite.from_motions([motion]), records)
    np.testing.assert_allclose(reliab.ellipses(records)["a"], traced_ellipses["a"], rtol=1e-6)


def test_a_criterion_is_derived_from_a_name_a_file_a_table_or_a_dataset():
    file = shipped("datasets", "paper/table2.csv")
    question = {"method": "quantile", "f": 1.0, "xi": 0.02}
    reference = reliab.derive_criterion(file, **question)
    assert reliab.derive_criterion(str(file), **question) == reference
    assert reliab.derive_criterion(pd.read_csv(file), **question) == reference
    assert reliab.derive_criterion(reliab.read_ellipses(file), **question) == reference
    named_criterion = reliab.derive_criterion("real_suite", f=1.0, xi=0.02)
    assert float(named_criterion.limits(1.0, 0.02)[1]) == pytest.approx(0.867, abs=0.01)


@pytest.mark.slow
def test_a_criterion_between_stored_structures_equals_the_command(capsys):
    options = (
        "--ellipses",
        "real_suite",
        "--method",
        "quantile",
        "--f",
        "1.3",
        "--xi",
        "0.02",
        "--json",
        "-",
    )
    assert cli.run(["criterion", *options]) == 0
    row = json.loads(capsys.readouterr().out)["criteria"][0]
    criterion = reliab.derive_criterion("real_suite", method="quantile", f=1.3, xi=0.02)
    assert (row["f"], row["a"], row["b"]) == (1.3, *map(float, criterion.limits(1.3, 0.02)))
    with pytest.raises(reliab.InputError, match="were not traced"):
        reliab.derive_criterion("real_suite", f=13.0)


def test_a_design_equals_the_command(capsys):
    assert cli.run(["design", "--f", "1", "2", "--confidence", "0.95", "--json", "-"]) == 0
    design = reliab.design_test(f=[1, 2], confidence=0.95)
    assert design.to_dict() == json.loads(capsys.readouterr().out)
    assert design.to_dataframe()["f"].tolist() == [1.0, 2.0]
    with pytest.raises(reliab.InputError, match="exact values"):
        reliab.design_test(f="1±0.1")


@pytest.mark.parametrize(
    ("call", "rule"),
    [
        (lambda: reliab.derive_criterion("nothing"), "name real_suite"),
        (lambda: reliab.derive_criterion(xr.Dataset()), "holds neither ellipses"),
        (lambda: reliab.derive_criterion(pd.DataFrame({"a": [1.0]})), "No column b"),
        (lambda: reliab.open_results("nothing"), "name real_suite"),
        (lambda: reliab.diagnose("nothing"), "a folder that holds campaign.toml"),
        (lambda: reliab.assess(pd.DataFrame({"x": [1.0]}), f=1, xi=0.02), "the data frame"),
    ],
)
def test_unknown_sources_are_refused(call, rule):
    with pytest.raises(reliab.InputError, match=rule):
        call()


def test_a_data_frame_is_judged_as_its_file_is():
    file = shipped("datasets", "sample_test/test.csv")
    frame = pd.read_csv(file, comment="#")
    frame.attrs = {"f": 1.0, "xi": 0.02, "skew_ms": "0±0.41"}
    frame_answer, file_answer = reliab.assess(frame).to_dict(), reliab.assess(file, f=1, xi=0.02).to_dict()
    assert frame_answer["error"]["rms"]["value"] == file_answer["error"]["rms"]["value"]
    assert frame_answer["verdict"] == file_answer["verdict"]


def test_printed_results_take_one_line(motion):
    criterion = reliab.published_criterion("guo_2017_18")
    results = (
        reliab.assess("sample_test", f=1, xi=0.02),
        criterion,
        reliab.load_motions("synthetic"),
        reliab.read_campaign("rig_a"),
        reliab.Structure(frequency=1.0, damping_ratio=0.02),
    )
    for result in results:
        assert len(repr(result)) < 120, repr(result)
        assert "\n" not in repr(result)
    assert len(repr(motion)) < 250


def test_data_frames_without_names_are_counted_from_one():
    empty = pd.DataFrame({"command": [0.0], "measured": [0.0]})
    assert list(reliab.assess([empty, "none.csv", empty]).faults) == [
        "data frame 1",
        "none.csv",
        "data frame 3",
    ]


def test_tests_of_a_file_are_named_by_file_and_group(tmp_path):
    time = np.arange(400) / 200.0
    with h5py.File(tmp_path / "two.h5", "w") as file:
        for name in ("early", "late"):
            for column, values in (("time", time), ("command", np.sin(time)), ("measured", np.sin(time))):
                file[f"{name}/{column}"] = values
    reading = FileReading(units="m")
    assert reading.split_by_test(tmp_path / "two.h5") == {
        f"two.h5, {name}": replace(reading, test_name=name) for name in ("early", "late")
    }
    rows = "\n".join(f"{t},{np.sin(t)},{np.sin(t)}" for t in time)
    (tmp_path / "one.csv").write_text(f"time_s,command_m,measured_m\n{rows}\n", encoding="utf-8")
    assert reading.split_by_test(tmp_path / "one.csv") == {"one.csv": reading}


RESULTS_WITH_ROWS = {
    "criteria": lambda: derive_criteria(ellipses="real_suite", f=[1, 2], xi=0.02, method="quantile"),
    "design": lambda: reliab.design_test(f=[1, 2]),
    "ellipses": lambda: trace_boundaries(motions="synthetic", f=1.0, xi=0.02),
    "motions": lambda: list_motions("synthetic"),
    "effects": lambda: reliab.diagnose("rig_a"),
}


@pytest.mark.slow
@pytest.mark.default_cases(2)
@pytest.mark.parametrize("key", RESULTS_WITH_ROWS)
def test_rows_of_a_result_are_a_table(key):
    result = RESULTS_WITH_ROWS[key]()
    rows, table = result.to_dict()[key], result.to_dataframe()
    assert result.summary()
    assert result._repr_html_().startswith("<")
    assert result.plot() is not None
    assert len(table) == len(rows) > 0
    for name, value in rows[-1].items():
        if isinstance(value, float | int | str):
            assert table[name].iloc[-1] == value
