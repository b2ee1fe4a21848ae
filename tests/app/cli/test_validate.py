import json
import re

import numpy as np
import pytest
import typer
from typer.testing import CliRunner, Result

from reliab.app.cli.validate import validate
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.validation.counts import list_kept_shares

app = typer.Typer()
app.command()(validate)
TABLE2 = shipped("datasets", "paper/table2.csv")


def run(*arguments: object) -> Result:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def answer(*arguments: object) -> dict:
    return json.loads(run(*arguments, "--json", "-").stdout)


def run_both(folder, *arguments: object) -> tuple[str, dict]:
    """What stands on the screen, and the numbers of the same run."""
    output = run(*arguments, "--json", folder / "found.json").stdout
    return output, json.loads((folder / "found.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def table2():
    return answer("--ellipses", TABLE2)


@pytest.mark.slow
def test_calibration_curve_has_rates_with_intervals_and_whole_confusion_matrices(table2):
    ours = [row for row in table2["rows"] if row["candidate"] == "dirichlet"]
    assert [row["confidence"] for row in ours] == [0.5, 0.6, 0.7, 0.8, 0.9, 0.95]
    assert table2["not_carried"] == [{"candidate": "dirichlet", "confidence": 0.99}]
    for row in ours:
        rate = row["containment"]
        assert rate["low"] <= rate["rate"] <= rate["high"]
        assert abs(rate["rate"] - row["confidence"]) < 0.15
        assert sum(row["confusion"].values()) == 100 * 512
    assert np.all(np.diff([row["accepted_share"]["rate"] for row in ours]) < 0.0)


def test_printed_laws_are_judged_where_they_promise_only(table2):
    output = [row for row in table2["rows"] if row["candidate"].startswith("guo_2017")]
    assert [(row["candidate"], row["confidence"]) for row in output] == [
        ("guo_2017_15", 0.95),
        ("guo_2017_18", 0.95),
    ]


@pytest.mark.slow
def test_shipped_results_report_the_fate_of_tests(tmp_path):
    arguments = ("--results", "real_suite", "--f", 1, "--xi", 0.02, "--confidence", 0.95, "--trials", 128)
    cells, result = run_both(tmp_path, *arguments)
    ours, _, eq18 = result["rows"]
    assert result["truth"] == "simulated"
    assert (result["n_motions"], result["n_events"]) == (100, 19)
    assert 0.95 <= ours["containment"]["rate"] < 1.0  # protected over lengths
    assert ours["false_safe"]["rate"] < 0.05 < eq18["false_safe"]["rate"]
    output = "guo_2017_18 does not keep what it states: it protects 12.0 % of the motions at 95 %"
    assert output in cells
    for row in result["rows"]:
        verb = "keeps" if row["containment"]["low"] >= row["confidence"] else "(may|does not) keep"
        assert re.search(f"{row['candidate']} {verb}", cells)


def test_every_method_and_law_is_told_whether_its_share_is_kept():
    rates = {
        "kept": (0.98, 0.96, 0.99),
        "scattered": (0.94, 0.9, 0.97),
        "one": (1.0, 0.025, 1.0),
        "broken": (0.5, 0.4, 0.6),
    }
    rows = [
        {"candidate": name, "confidence": 0.95, "containment": {"rate": rate, "low": low, "high": high}}
        for name, (rate, low, high) in rates.items()
    ]
    empty_row = {
        "candidate": "few",
        "confidence": 0.95,
        "containment": dict.fromkeys(("rate", "low", "high")),
    }
    extra = [{**row, "confidence": 0.3} for row in rows]
    sentences = list(list_kept_shares([*rows, empty_row, *extra]))
    for sentence, (name, verb) in zip(
        sentences,
        (("kept", "keeps"), ("scattered", "may keep"), ("one", "may keep"), ("broken", "does not keep")),
        strict=True,
    ):
        assert f"{verb} what it states" in sentence
        assert sentence.startswith(f"{name} ")
        assert f"{100 * rates[name][0]:.1f} % of the motions at 95 %" in sentence
    assert "does not keep what it states at 95 %; it keeps" in sentences[-1]


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("scheme", ["k_fold", "random_halves"])
def test_earthquakes_are_divided_as_asked(scheme):
    content = answer("--ellipses", TABLE2, "--scheme", scheme, "--confidence", 0.9, "--law", "table")
    assert content["scheme"] == scheme
    assert 0.75 < content["rows"][0]["containment"]["rate"] < 1.0


@pytest.mark.slow
def test_frequencies_can_be_left_out():
    content = answer(
        *("--ellipses", "real_suite", "--xi", 0.02, "--leave-out", "f", "--scheme", "k_fold"),
        *("--law", "dimensionless", "--confidence", 0.95, "--f", 0.5, "--f", 1, "--f", 1.5, "--f", 2),
    )
    assert [row["f"] for row in content["by_frequency"]] == [1.0, 1.5]  # a law does not extrapolate
    assert content["scheme"] == "k_fold, each f left out"


@pytest.mark.slow
def test_sets_are_judged_by_others(tmp_path):
    from reliab.motions.catalogue import write_suite
    from reliab.motions.synthetic.suite import synthetic_suite

    write_suite(synthetic_suite(count=12), tmp_path / "suite")
    path = tmp_path / "suite" / "catalog.csv"
    header, *rows = path.read_text(encoding="utf-8").splitlines()
    place = header.split(",").index("set")
    cells = [row.split(",") for row in rows]
    for number, row in enumerate(cells):
        row[place] = "far" if number < 8 else "near"
    path.write_text("\n".join([header, *(",".join(row) for row in cells)]), encoding="utf-8")
    content = answer(
        *("--motions", tmp_path / "suite", "--learn", "far", "--judge", "near"),
        *("--confidence", 0.8, "--law", "table"),
    )
    assert content["scheme"] == "learned from far, judged on near"
    assert sum(content["rows"][0]["confusion"].values()) == 4 * 512


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wrong", "rule"),
    [
        ((), r"No source of ellipses"),
        (("--ellipses", TABLE2, "--results", "real_suite"), r"one source of ellipses; found 2"),
        (("--ellipses", TABLE2, "--scheme", "magic"), "Unknown scheme"),
        (("--ellipses", TABLE2, "--law", "magic"), "Unknown law"),
        (("--ellipses", TABLE2, "--method", "magic"), "Unknown method"),
        (("--ellipses", TABLE2, "--leave-out", "kp"), "`leave_out` is f or xi"),
        (("--ellipses", TABLE2, "--learn", "far_field"), "needs `motions`, `learn` and `judge`"),
        (("--ellipses", TABLE2, "--confidence", 95), "confidence must lie between"),
        (
            ("--motions", "synthetic", "--learn", "synthetic", "--judge", "none"),
            "motions have no such set",
        ),
    ],
)
def test_bad_input_is_explained(wrong, rule):
    refusal = run(*wrong).exception
    assert isinstance(refusal, InputError)
    assert re.search(rule, str(refusal))


@pytest.mark.slow
def test_own_motions_are_judged_by_the_shipped_suite(tmp_path):
    from reliab.motions.catalogue import write_suite
    from reliab.motions.synthetic.suite import synthetic_suite

    write_suite(synthetic_suite(count=4), tmp_path / "suite")
    path = tmp_path / "suite" / "catalog.csv"
    path.write_text(
        path.read_text(encoding="utf-8").replace("SYN001,", "KOBE JAPAN 1995-01-16,"), encoding="utf-8"
    )
    base_arguments = (
        *("--motions", tmp_path / "suite", "--learn", "real_suite"),
        *("--confidence", 0.8, "--law", "table", "--trials", 64),
    )
    output, result = run_both(tmp_path, *base_arguments)
    assert result["scheme"] == "learned from real_suite"
    assert result["truth"] == "simulated"
    assert result["n_of_learned_earthquakes"] == 2  # both components of the earthquake that is called Kobe's
    assert sum(result["rows"][0]["confusion"].values()) == 4 * 64
    assert "2 of the motions are of earthquakes that the suite holds" in output
    for idle in (("--judge", "synthetic"), ("--scheme", "k_fold")):
        assert isinstance(run(*base_arguments, *idle).exception, InputError)
