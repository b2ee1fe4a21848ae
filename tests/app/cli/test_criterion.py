import json
import re
from types import SimpleNamespace

import numpy as np
import pytest
import typer
from typer.testing import CliRunner, Result

from reliab.app.api.derived_criteria import _plane
from reliab.app.cli.criterion import criterion
from reliab.core.errors import IncompleteError, InputError
from reliab.core.shipped import shipped
from reliab.criterion.criterion import Criterion
from reliab.report.style import FigureWarning

app = typer.Typer()
app.command()(criterion)
TABLE2 = shipped("datasets", "paper/table2.csv")


def run(*arguments: object) -> Result:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def answer(*arguments: object) -> dict:
    return json.loads(run(*arguments, "--json", "-").stdout)


def test_the_printed_table_gives_the_printed_criterion():
    content = answer("--ellipses", TABLE2, "--method", "quantile")
    assert content["a"] == pytest.approx(5.29e-5, abs=0.005e-5)
    assert content["b"] == pytest.approx(1.048, abs=0.0005)
    assert content["correlation"] == pytest.approx(0.977, abs=0.0005)
    assert (content["f"], content["xi"], content["threshold"]) == (1.0, 0.02, 0.05)
    assert (content["confidence"], content["method"]) == (0.95, "quantile")
    assert (content["n_motions"], content["n_events"]) == (100, 19)


def test_the_roots_are_the_limits_of_a_test():
    content = answer("--ellipses", TABLE2)
    assert content["amplitude_limit"] ** 2 == pytest.approx(content["a"])
    assert content["delay_limit_ms"] ** 2 == pytest.approx(content["b"])


def test_one_criterion_stands_at_the_top_too():
    content = answer("--ellipses", TABLE2)
    (only,) = content["criteria"]
    assert {name: content[name] for name in only} == only


def test_several_confidences_give_a_list_in_order_and_no_top_level_values():
    content = answer("--ellipses", TABLE2, "--confidence", 0.9, "--confidence", 0.99)
    assert set(content) == {"criteria"}
    assert [row["confidence"] for row in content["criteria"]] == [0.9, 0.99]
    assert content["criteria"][0]["a"] > content["criteria"][1]["a"]


def test_the_table_shows_the_limits_and_the_number_of_earthquakes():
    output = run("--ellipses", TABLE2, "--method", "quantile").stdout
    assert "100 ground motions of 19 earthquakes" in output
    assert "5.29e-05" in output
    assert "1.05" in output


def test_the_table_defines_error_window_and_limits():
    output = run("--ellipses", "real_suite", "--f", 1, "--xi", 0.02, "--details").stdout
    for words in (
        "RMS^R: RMS of measured minus exact displacement over peak exact displacement",
        "Window: record",
        "Share α of the stiffness in the laboratory: 1.",
        "|A − 1| alone ≤",
        "lag alone ≤ [ms]",
        "lead alone ≤ [ms]",
    ):
        assert words in output


@pytest.mark.slow
def test_a_printed_law_says_how_many_real_motions_keep_it():
    for law, least, most in (("guo_2017_18", 0.05, 0.20), ("guo_2017_12", 0.90, 1.0)):
        content = answer("--law", law)
        assert least < content["kept_by"]["share"] < most
        assert (
            f"{100 * content['kept_by']['share']:.0f} % have a boundary that contains"
            in content["warnings"][0]
        )


def test_one_default_the_recommended_method_and_joint():
    content = answer("--ellipses", TABLE2)
    assert (content["method"], content["joint"]) == ("dirichlet", True)
    assert content["a"] == answer("--ellipses", TABLE2, "--method", "dirichlet", "--joint")["a"]
    paper = answer("--ellipses", TABLE2, "--method", "quantile")
    assert (paper["method"], paper["joint"], paper["curve"]) == ("quantile", False, "ellipse")


def test_three_motions_of_one_earthquake_carry_no_criterion(tmp_path):
    table = tmp_path / "three.csv"
    table.write_text("motion,event,a,b\nK/1,K,1e-4,1\nK/2,K,2e-4,2\nK/3,K,3e-4,4\n")
    for method in ("dirichlet", "quantile", "order_statistic"):
        content = answer("--ellipses", table, "--method", method)
        assert (content["a"], content["b"]) == (0.0, 0.0)
        assert content["carried_confidence"] <= 0.5
        assert "no test is accepted" in content["warnings"][0]


def test_synthetic_motions_are_called_so(tmp_path):
    table = tmp_path / "synthetic.csv"
    rows = "".join(f"SYN{k:03d}/H1,{1e-4 * (1.0 + 0.1 * k)},{2.0 + 0.1 * (k % 3)}\n" for k in range(1, 31))
    table.write_text("motion,a,b\n" + rows)
    assert "30 synthetic ground motions of 30 earthquakes" in run("--ellipses", table).stdout


@pytest.mark.slow
def test_motions_are_simulated_then_and_there(tmp_path):
    from reliab.motions.catalogue import write_suite
    from reliab.motions.synthetic.suite import synthetic_suite

    write_suite(synthetic_suite(count=6), tmp_path / "suite")
    content = answer(
        *("--motions", tmp_path / "suite", "--f", 1, "--f", 2, "--threshold", 0.05, "--threshold", 0.1),
        *("--confidence", 0.7),
    )
    assert [(row["f"], row["threshold"]) for row in content["criteria"]] == [
        (1.0, 0.05), (1.0, 0.1), (2.0, 0.05), (2.0, 0.1),
    ]  # fmt: skip
    assert {row["n_events"] for row in content["criteria"]} == {3}


def test_a_published_law_needs_no_motions():
    content = answer("--law", "guo_2017_18", "--f", 1, "--xi", 0.05)
    assert (content["a"], content["law"]) == (pytest.approx(0.021 * 0.05), "guo_2017_18")


def test_the_recommended_method_is_smaller_than_the_plug_in():
    plug_in, content = answer("--ellipses", TABLE2, "--method", "quantile"), answer("--ellipses", TABLE2)
    assert content["joint"] is True
    assert 0.5 < content["a"] / plug_in["a"] < 1.25


def test_the_criterion_can_be_kept_for_later(tmp_path):
    content = answer("--ellipses", TABLE2, "--out", tmp_path / "criterion.json")
    saved = Criterion.from_json((tmp_path / "criterion.json").read_text(encoding="utf-8"))
    assert [float(limit) for limit in saved.limits(1.0, 0.02)] == pytest.approx([content["a"], content["b"]])
    assert 0.9 < float(saved.probability(1.0 + content["amplitude_limit"], 0.0, 1.0, 0.02)) < 1.0


def test_rejected_lognormality_is_said():
    warnings = answer("--ellipses", TABLE2, "--method", "quantile")["warnings"]
    assert any("b is not lognormal" in warning for warning in warnings)
    free = answer("--ellipses", TABLE2, "--method", "dirichlet")["warnings"]
    assert not any("lognormal" in warning for warning in free)


@pytest.mark.parametrize(
    ("wrong", "rule"),
    [
        (("--sets", "a"), r"No source of ellipses"),
        (("--law", "guo_2017_11"), "Unknown law"),
        (("--law", "guo_2017_15", "--xi", 0.05), "does not hold for this"),
        (("--ellipses", TABLE2, "--law", "magic"), "Unknown law"),
        (
            ("--ellipses", TABLE2, "--confidence", 0.9, "--confidence", 0.95, "--out", "criterion.json"),
            "A file holds one criterion",
        ),
        (("--ellipses", TABLE2, "--method", "tolerance", "--assurance", 2), "assurance must lie between"),
        (("--ellipses", TABLE2, "--distribution", "magic"), "dirichlet has no distribution"),
        (("--ellipses", TABLE2, "--assurance", 0.9), "dirichlet has no assurance"),
        (("--ellipses", TABLE2, "--chains", "chains.h5"), "Only the hierarchical methods have chains"),
        (("--ellipses", TABLE2, "--steps", 400), "dirichlet has no steps"),
        (
            ("--ellipses", TABLE2, "--method", "hierarchical", "--steps", 402),
            "multiple of twice the thinning",
        ),
        (("--ellipses", TABLE2, "--method", "hierarchical", "--law", "exponential"), "do not take this law"),
        (
            ("--ellipses", TABLE2, "--method", "hierarchical", "--distribution", "weibull"),
            "hierarchical has no distribution",
        ),
        (
            ("--ellipses", TABLE2, "--method", "hierarchical", "--chains", TABLE2, "--steps", 40),
            "chains must be an HDF5 file",
        ),
        (("--ellipses", TABLE2, "--figures", TABLE2), "no folder for figures"),
        (("--ellipses", TABLE2, "--law", "guo_2017_12"), "needs no motions"),
        (("--law", "guo_2017_12", "--figures", "figures"), "needs a source of ellipses"),
        (("--law", "guo_2017_18", "--threshold", 0.02), "for an error of 0.05 only"),
        (("--law", "guo_2017_18", "--confidence", 0.99), r"is for 95 %.*confidence"),
        (("--law", "guo_2017_18", "--method", "dirichlet"), r"is for 95 %.*method"),
        (("--law", "guo_2017_18", "--metric", "mte"), "for the metric rms only"),
        (("--ellipses", TABLE2, "--motions", "synthetic"), r"one source of ellipses; found 2"),
        (("--ellipses", TABLE2, "--confidence", 95), "confidence must lie between"),
        (("--ellipses", TABLE2, "--method", "magic"), "Unknown method"),
        (("--ellipses", TABLE2, "--f", 1, "--f", 2), "traced for another f"),
        (("--ellipses", "none.csv"), "No such file"),
    ],
)
def test_bad_input_is_explained(wrong, rule):
    refusal = run(*wrong).exception
    assert isinstance(refusal, InputError)
    assert re.search(rule, str(refusal))


def test_stored_results_answer_for_any_threshold(tmp_path):
    from reliab.motions.synthetic.suite import synthetic_suite
    from reliab.sweep.request import ScaledGrid, SweepRequest
    from reliab.sweep.run import run_sweep

    request = SweepRequest(
        frequencies=(1.0,), damping_ratios=(0.05,), grid=ScaledGrid(gain_steps=14, delay_steps=20)
    )
    store = run_sweep(synthetic_suite(count=6), request, tmp_path / "results.zarr")
    content = answer("--results", store, "--threshold", 0.1, "--threshold", 0.05, "--confidence", 0.7)
    assert [row["threshold"] for row in content["criteria"]] == [0.1, 0.05]
    assert content["criteria"][0]["a"] > content["criteria"][1]["a"]


def run_short_chain(*arguments: object) -> Result:
    result = run("--ellipses", TABLE2, "--method", "hierarchical", "--steps", 40, *arguments)
    assert isinstance(result.exception, IncompleteError)
    assert "HAS NOT CONVERGED" in str(result.exception)
    return result


@pytest.mark.slow
def test_unconverged_posterior_warns_and_exits_unfinished(tmp_path):
    out, figures = tmp_path / "criterion.json", tmp_path / "figures"
    output = json.loads(run_short_chain("--out", out, "--figures", figures, "--json", "-").stdout)
    assert output["converged"] is False
    assert "NOT CONVERGED" in output["warnings"][0]
    (posterior,) = output["posteriors"]
    assert not posterior["converged"]
    assert posterior["complaints"]
    assert {"r_hat", "bulk_size", "tail_size", "autocorrelation_time"} <= set(posterior["parameters"][0])
    assert not out.exists()
    figure_names = {path.name for path in figures.iterdir()}
    assert figure_names == set(output["figures"])
    assert {
        "traces_rms0.05.svg",
        "ranks_rms0.05.svg",
        "pairs_rms0.05.svg",
        "posterior_rms0.05.nc",
    } <= figure_names
    cells = run_short_chain().stdout
    assert "THIS POSTERIOR HAS NOT CONVERGED" in cells
    assert "autocorrelation time" in cells


def test_bad_convergence_has_its_own_exit_code(capfd):
    from reliab.app.cli import run as main

    arguments = ["criterion", "--ellipses", str(TABLE2), "--method", "hierarchical", "--steps", "40"]
    assert main(arguments) == 3
    assert "NOT CONVERGED" in capfd.readouterr().err


@pytest.mark.slow
def test_chains_go_on_where_they_ended(tmp_path):
    chains = tmp_path / "chains.h5"
    output = json.loads(run_short_chain("--json", "-").stdout)
    run("--ellipses", TABLE2, "--method", "hierarchical", "--steps", 20, "--chains", chains)
    resumed = json.loads(run_short_chain("--chains", chains, "--json", "-").stdout)
    assert (resumed["a"], resumed["b"]) == (output["a"], output["b"])


@pytest.fixture(scope="module")
def ellipses_of_twelve(tmp_path_factory):
    """Ellipses of twelve synthetic motions at four structures."""
    from reliab.motions.synthetic.suite import synthetic_suite
    from reliab.sweep.ellipse_dataset import write_ellipses
    from reliab.sweep.ellipse_table import EllipseRequest, trace_ellipses

    request = EllipseRequest(frequencies=(0.5, 1.0), damping_ratios=(0.02, 0.05))
    file = tmp_path_factory.mktemp("ellipses") / "ellipses.nc"
    write_ellipses(trace_ellipses(synthetic_suite(count=12), request), file)
    return file


@pytest.mark.slow
def test_a_converged_posterior_is_a_finished_answer(ellipses_of_twelve):
    structure = ("--f", 1, "--xi", 0.05)
    result = run("--ellipses", ellipses_of_twelve, *structure, "--method", "hierarchical", "--json", "-")
    assert result.exit_code == 0
    output = json.loads(result.stdout)
    assert output["converged"] is True
    assert output["largest_r_hat"] < 1.01
    assert output["least_effective_size"] > 1000.0


def test_criteria_are_drawn_over_the_motions_own_ellipses(tmp_path):
    content = answer(
        *(
            "--ellipses",
            TABLE2,
            "--confidence",
            0.9,
            "--confidence",
            0.95,
            "--figures",
            tmp_path / "new" / "one",
        )
    )
    assert content["figures"] == ["criterion_f1_xi0.02_rms0.05.svg"]
    assert (tmp_path / "new" / "one" / content["figures"][0]).read_bytes().startswith(b"<?xml")


def test_a_printed_law_can_be_drawn_over_ellipses(tmp_path):
    content = answer("--ellipses", TABLE2, "--law", "guo_2017_18", "--figures", tmp_path)
    assert content["law"] == "guo_2017_18"
    assert len(content["figures"]) == 1


def test_structure_without_ellipses_gets_a_criterion_and_no_figure(tmp_path):
    arguments = (
        "--ellipses",
        "real_suite",
        "--f",
        1,
        "--f",
        1.13,
        "--xi",
        0.02,
        "--figures",
        tmp_path / "figures",
    )
    with pytest.warns(FigureWarning, match=r"No figure for f = 1.13 Hz.*Choose f among 0.25, 0.5"):
        content = answer(*arguments, "--out", tmp_path / "criterion.json")
    assert [row["f"] for row in content["criteria"]] == [1, 1.13]
    assert (tmp_path / "criterion.json").is_file()
    assert content["figures"] == ["criterion_f1_xi0.02_rms0.05.svg"]


@pytest.mark.parametrize("converged", [True, False])
def test_figure_warns_of_an_unconverged_posterior(grouped_ellipses, converged):
    criterion = SimpleNamespace(
        threshold=0.05,
        metric="rms",
        confidence=0.9,
        promise=0.9,
        population="of here",
        law=SimpleNamespace(name="table"),
        limits=lambda f, xi: (1e-4 * f, 40.0 * xi),
        provenance=SimpleNamespace(curve="ellipse", settings={"converged": converged}),
    )
    output = SimpleNamespace(**{**vars(criterion), "population": None})
    nothing = SimpleNamespace(**{**vars(criterion), "limits": lambda _f, _xi: (0.0, 1.0), "confidence": 0.5})
    figure = _plane(grouped_ellipses, [criterion, output, nothing], 1.0, 0.05)
    (place,) = figure.axes
    assert place.get_title() == ("" if converged else "POSTERIOR NOT CONVERGED: not to be relied on")
    names = {line.get_label(): line.get_xydata() for line in place.lines}
    assert {"90 % of motions", "table, stated for 90 % of motions"} <= set(names)
    assert not any(str(name).startswith("50 %") for name in names)
    x, y = names["90 % of motions"].T
    np.testing.assert_allclose((x - 1.0) ** 2 / 1e-4 + y**2 / 2.0, 1.0)
