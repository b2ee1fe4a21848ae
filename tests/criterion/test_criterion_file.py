"""Criteria as JSON, and the printed ones."""

import json

import pytest

from reliab.core.errors import InputError
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.methods.quantile import Quantile
from reliab.criterion.population import sample_of


@pytest.fixture(scope="module")
def text(two_sided):
    return derive_criterion(two_sided).to_json()


def broken(text, change):
    content = json.loads(text)
    change(content)
    return json.dumps(content)


KEYS = ("threshold", "metric", "confidence", "method", "joint", "law", "lead_law", "population", "provenance")


@pytest.mark.parametrize("key", [*KEYS, "lead_population", "schema_version"])
def test_a_missing_key_is_named(text, key):
    with pytest.raises(InputError, match="schema" if key == "schema_version" else f"{key} is missing"):
        Criterion.from_json(broken(text, lambda content: content.pop(key)))


@pytest.mark.parametrize("key", ["window", "warnings", "n_events", "curve"])
def test_a_missing_key_of_the_provenance_is_named(text, key):
    with pytest.raises(InputError, match=f"provenance.{key} is missing"):
        Criterion.from_json(broken(text, lambda content: content["provenance"].pop(key)))


def set_in(*path, value):
    def change(content):
        *parents, last = path
        for key in parents:
            content = content[key]
        content[last] = value

    return change


@pytest.mark.parametrize(
    "change",
    [
        set_in("law", "b", value=[[1, 2]]),
        set_in("law", "b", 0, 0, value=-1.0),
        set_in("law", "a", 0, 0, value="much"),
        set_in("law", "a", value=3.0),
        set_in("law", "frequencies", 0, value=9.0),
        set_in("law", "name", value="magic"),
        set_in("law", "name", value=["table"]),
        set_in("law", value=7),
        set_in("law", value=None),
        set_in("law", "frequencies", 0, value="0.5"),
        set_in("law", "a", 0, value="12"),
        set_in("population", "events", 0, value=["K"]),
        set_in("population", "log_alpha", 0, 0, 0, value="-8"),
        set_in("provenance", "experimental_fraction", value="1"),
        set_in("provenance", "packages", value={"numpy": 2}),
        set_in("law", "more", value=1.0),
        set_in("lead_law", "b", 0, 0, value=None),
        set_in("population", "log_alpha", 0, value=[[1.0]]),
        set_in("population", "log_alpha", value=[1.0]),
        set_in("population", "events", value=["K"]),
        set_in("threshold", value="5 %"),
        set_in("threshold", value=0.0),
        set_in("threshold", value=True),
        set_in("confidence", value=95),
        set_in("joint", value="yes"),
        set_in("method", value=3),
        set_in("metric", value="mean"),
        set_in("provenance", "warnings", value="none"),
        set_in("provenance", "n_events", value="many"),
        set_in("provenance", value=None),
        set_in("surprise", value=1),
    ],
)
def test_file_without_criterion_is_refused(text, change):
    with pytest.raises(InputError):
        Criterion.from_json(broken(text, change))


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999"])
@pytest.mark.parametrize("key", ["threshold", "largest"])
def test_reading_refuses_non_finite_numbers(text, number, key):
    wrong = broken(
        text, set_in(key, value="here") if key == "threshold" else set_in("law", "a", 0, 0, value="here")
    )
    with pytest.raises(InputError, match="finite"):
        Criterion.from_json(wrong.replace('"here"', number))


def test_writing_refuses_non_finite_numbers(two_sided):
    criterion = derive_criterion(two_sided)
    criterion.provenance.settings["strange"] = float("nan")
    with pytest.raises(ValueError, match="not JSON compliant"):
        criterion.to_json()


def test_file_of_first_schema_names_missing_parts(text):
    with pytest.raises(InputError, match="version 1, which has no limits for leads"):
        Criterion.from_json(broken(text, set_in("schema_version", value=1)))


def test_equation_12_follows_from_table_2(printed_table2):
    criterion = derive_criterion(printed_table2, f=1.0, xi=0.02, method=Quantile(), joint=False)
    a, b = criterion.limits(1.0, 0.02)
    assert float(a) == pytest.approx(5.29e-5, abs=0.005e-5)
    assert float(b) == pytest.approx(1.048, abs=0.0005)


def test_the_correlation_is_the_printed_one(printed_table2):
    sample = sample_of(printed_table2, frequency=1.0, damping_ratio=0.02, threshold=0.05, metric="rms")
    assert sample.correlation == pytest.approx(0.9774, abs=0.00005)
