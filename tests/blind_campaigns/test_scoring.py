"""Scoring: a perfect product, a careless one, and the statistics themselves."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from blind_campaigns.labels import Label, write_label
from blind_campaigns.outcomes import Outcome, read_names
from blind_campaigns.scoring import coverage, main, reliability, score, table, wilson_interval

NAMES = {"gap": {"gap_m": {"name": "width_m", "factor": 2.0}}, "hysteresis": {"beta": False}}


def label(kind: str, *names: str, number: int = 0, twins: tuple[str, ...] = (), **remaining: Any) -> Label:
    effects = [
        {
            "name": name, "parameters": {"gap_m": {"value": 2.0, "units": "m"}}, "effect_to_noise_db": 5.0,
            "degenerate_with": list(twins),
        }
        for name in names
    ]  # fmt: skip
    verdicts = {
        "none": "no_missing_effect",
        "miscalibrated": "no_missing_effect",
        "outside": "unknown_effect",
    }
    return Label(
        campaign=f"{kind}_{number}", seed=number, kind=kind, verdict=verdicts.get(kind, "named"),
        observation="full", effects=effects, calibration={}, structure=None, specimen=None,
        noise={"kind": "white", "snr_db": 35.0}, tests=[], rate_hz=1024.0, **remaining,
    )  # fmt: skip


def answer(verdict: str, *names: str, **remaining: Any) -> dict[str, Any]:
    effects = [
        {"name": name, "probability": 0.9, "parameters": {"width_m": {"value": 4.1, "sd": 0.1}}, "rivals": []}
        for name in names
    ]
    return {"verdict": verdict, "effects": effects, "where": [], **remaining}


def perfect(label_of_case: Label) -> Outcome:
    effects = sorted(label_of_case.names) if label_of_case.verdict == "named" else []
    result = answer(
        label_of_case.verdict, *effects, gap={"closed_fraction": 0.995}, unknown={"expression": "x^2 v"}
    )
    return Outcome(label=label_of_case, result=result)


LABELS = [
    *(label("single", "gap", number=n) for n in range(6)),
    label("faint", "gap"),
    label("double", "gap", "hysteresis"),
    label("triple", "gap", "hysteresis", "sensor_bias"),
    label("none"),
    label("miscalibrated"),
    label("outside", "slip_lock"),
    label("one_channel", "gap"),
]


def test_a_perfect_product_reaches_every_target() -> None:
    figures = score([perfect(label_of_case) for label_of_case in LABELS], NAMES)
    assert all(figure["reached"] for figure in figures["rates"].values() if figure["target"] is not None)
    assert figures["closed_fraction"]["reached"]
    assert figures["failures"] == []
    assert "single named right, alone" in table(figures)


def test_a_careless_product_reaches_none() -> None:
    figures = score(
        [Outcome(label=label_of_case, result=answer("named", "backlash")) for label_of_case in LABELS], NAMES
    )["rates"]
    missed_targets = {
        name for name, figure in figures.items() if figure["target"] is not None and not figure["reached"]
    }
    assert missed_targets == set(figures) - {"answered", "faint called unknown", "faint named right"}


def test_missing_answers_count_as_failures() -> None:
    figures = score([Outcome(label=label_of_case, result=None) for label_of_case in LABELS], NAMES)
    assert figures["rates"]["single named right, alone"]["share"] == 0.0
    assert len(figures["failures"]) == len(LABELS)


def test_calibration_is_no_name() -> None:
    outcome = Outcome(
        label=label("miscalibrated"), result=answer("no_missing_effect", "gain_error", "delay_error")
    )
    assert outcome.named == set()
    right = Outcome(label=label("single", "gap"), result=answer("named", "gap", "gain_error"))
    assert right.exact


def test_honesty_needs_a_twin_in_the_label() -> None:
    twin = label("single", "first_order_lag", twins=("second_order_dynamics",))
    assert Outcome(label=twin, result=answer("named", "second_order_dynamics")).honest
    both = answer("not_identifiable", "first_order_lag", "second_order_dynamics")
    assert Outcome(label=twin, result=both).honest
    assert not Outcome(label=label("single", "first_order_lag"), result=both).honest
    assert not Outcome(label=twin, result=answer("named", "backlash")).honest


def test_coverage_translates_parameters() -> None:
    outcome = perfect(label("single", "gap"))
    assert coverage([outcome], NAMES)["share"] == 1.0
    assert coverage([outcome], {"gap": {"gap_m": "width_m"}})["share"] == 0.0
    assert coverage([outcome], {"gap": {"gap_m": False}})["of"] == 0


def test_reliability_holds_stated_against_true() -> None:
    outcomes = [perfect(label("single", "gap", number=n)) for n in range(9)]
    outcomes.append(Outcome(label=label("single", "backlash"), result=answer("named", "gap")))
    figures = reliability(outcomes)
    assert figures["n"] == 10
    assert figures["expected_calibration_error"] == pytest.approx(0.0)


def test_wilson_interval_is_the_textbooks() -> None:
    assert wilson_interval(9, 10) == pytest.approx((0.5958, 0.9821), abs=1e-4)
    assert wilson_interval(0, 20)[0] == pytest.approx(0.0)
    assert wilson_interval(0, 0) == (0.0, 1.0)


def test_command_line_reads_labels_and_results(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for folder in ("labels", "results"):
        (tmp_path / folder).mkdir()
    for label_of_case in LABELS:
        write_label(label_of_case, tmp_path / "labels")
        (tmp_path / "results" / f"{label_of_case.campaign}.json").write_text(
            json.dumps(perfect(label_of_case).result), encoding="utf-8"
        )
    main([str(tmp_path / "labels"), str(tmp_path / "results"), "--json", str(tmp_path / "figures.json")])
    assert "13 campaigns" in capsys.readouterr().out
    figures = json.loads((tmp_path / "figures.json").read_text(encoding="utf-8"))
    assert figures["rates"]["answered"]["share"] == 1.0


def test_shipped_translation_is_readable() -> None:
    from blind_campaigns.catalogue import registry

    names = read_names(Path(__file__).with_name("parameter_names.toml"))
    assert all(set(entries) <= set(registry()[effect].units) for effect, entries in names.items())


def test_added_force_offset_is_no_false_name() -> None:
    result = answer("named", "gap", "force_bias", changed=["force_offset"])
    assert Outcome(label=label("single", "gap"), result=result).exact
    assert not Outcome(label=label("single", "gap"), result={**result, "changed": []}).exact


@pytest.mark.parametrize(
    ("misstated", "told_count"), [(["structure_mass", "stiffness"], 1), (["stiffness"], 0)]
)
def test_wrong_structure_is_told_by_the_calibrated_value(misstated, told_count) -> None:
    result = answer("no_missing_effect", changed=["mass"], misstated=misstated)
    figures = score([Outcome(label=label("none"), result=result)], NAMES)
    assert figures["rates"]["f, xi or mass stated wrongly, told"]["count"] == told_count


@pytest.mark.parametrize(
    ("change", "observation", "share", "wrong_values"),
    [
        ("frequency", "full", 0.5, {"structure_frequency"}),
        ("frequency", "full", 1.0, {"stiffness"}),
        ("frequency", "one_channel_rig", 0.5, {"stiffness"}),
        ("mass", "full", 1.0, {"structure_mass"}),
        ("mass", "one_channel_oscillator", 1.0, set()),
        ("damping", "one_channel_oscillator", 1.0, {"structure_damping"}),
        ("frequency", "specimen_only", 1.0, set()),
    ],
)
def test_wrong_value_is_asked_for_only_if_the_channels_show_it(change, observation, share, wrong_values):
    label_of_case = replace(
        label("none"), observation=observation, structure={"experimental_fraction": share}
    )
    silent = Outcome(label=label_of_case, result=answer("no_missing_effect", changed=[change], misstated=[]))
    assert silent.wrongly_stated == wrong_values
    assert silent.told is (not wrong_values)
    outcome = Outcome(
        label=label_of_case, result=answer("no_missing_effect", changed=[change], misstated=[*wrong_values])
    )
    assert outcome.told


def test_unstated_mass_is_not_stated_wrongly() -> None:
    label_without_mass = replace(label("none"), structure={"experimental_fraction": 1.0, "mass_kg": None})
    assert not Outcome(label=label_without_mass, result=answer("named", changed=["mass"])).wrongly_stated


@pytest.mark.parametrize(("verdict", "is_told"), [("not_identifiable", True), ("named", False)])
def test_inseparable_dampings_are_told_by_naming_both(verdict, is_told):
    label_of_case = replace(label("none"), observation="one_channel_oscillator", structure={})
    result = answer(verdict, "viscous_damping", changed=["damping"], misstated=[])
    result["effects"][0]["rivals"] = [{"name": "structure_damping"}]
    assert Outcome(label=label_of_case, result=result).told is is_told
