"""Every door says where a ground motion lies among those behind a criterion, and promises nothing outside."""

import json
import re

import numpy as np
import pytest

import reliab
from reliab import cli
from reliab.criterion import Criterion
from reliab.motions import load_motions
from reliab.report.kinds.assessment import assessment_report
from reliab.simulation import Excitation
from reliab.simulation.linear_loop import respond

F, XI = 1.0, 0.02
MOTIONS = {"inside": 0, "at the edge": 10, "outside": 4}  # of the synthetic suite: 64, 86 and 102 s
SHARE = re.compile(r"\b95 ?%|\b0\.95\b")


@pytest.fixture(
    scope="module",
    params=["outside", *(pytest.param(name, marks=pytest.mark.slow) for name in ("inside", "at the edge"))],
)
def case(request, tmp_path_factory):
    """Where a motion lies, its record, a criterion for it, and a test that was run under it."""
    folder = tmp_path_factory.mktemp("doors")
    motion = load_motions("synthetic")[MOTIONS[request.param]]
    acceleration, step = motion.acceleration, motion.time_step
    times = step * np.arange(acceleration.size)
    record = folder / "motion.txt"
    np.savetxt(record, np.column_stack([times, acceleration]), header="units: m/s2")
    w0 = 2.0 * np.pi * F
    excitation = Excitation(acceleration=acceleration, time_step=step)
    exact, fine = respond(excitation, lambda s: 1.0 / (s**2 + 2.0 * XI * w0 * s + w0**2))
    grid = 0.005 * np.arange(int(times[-1] / 0.005))
    command, measured = (np.interp(grid - delay, fine * np.arange(exact.size), exact) for delay in (0, 5e-4))
    test = folder / "test.csv"
    columns = np.column_stack([grid, command, measured])
    np.savetxt(test, columns, delimiter=",", header="time_s,command_m,measured_m", comments="")
    asked = ("criterion", "--motion", record, "--f", F, "--xi", XI, "--confidence", 0.95)
    assert cli.run([str(part) for part in (*asked, "--out", folder / "criterion.json")]) == 0
    return request.param, folder


def said(capsys, *arguments):
    """What a command prints, words of one line each."""
    assert cli.run([str(argument) for argument in arguments]) in {0, 1}
    return " ".join(capsys.readouterr().out.split())


def test_the_criterion(case, capsys):
    position, folder = case
    asked = ("criterion", "--motion", folder / "motion.txt", "--f", F, "--xi", XI, "--confidence", 0.95)
    screen = said(capsys, *asked)
    assert ("What it is asked for lies" in screen) == (position != "inside")
    content = json.loads(said(capsys, *asked, "--json", "-"))
    assert content["position"] == position
    assert content["confidence"] == (None if position == "outside" else 0.95)
    assert "100 ground motions of 19 earthquakes" in content["population"]
    table = screen.split("confidence [-]")[1].split("Method:")[0]
    assert bool(SHARE.search(table)) == (position != "outside")
    said(capsys, *asked, "--figures", folder / "figures")
    (figure,) = (folder / "figures").glob("criterion_*.svg")
    drawn = figure.read_text(encoding="utf-8")
    assert ("no share promised" in drawn) == (position == "outside")
    assert ("95 % of motions" in drawn) == (position != "outside")


def test_the_design(case, capsys):
    position, folder = case
    asked = ("assess", "--design", "--criterion", folder / "criterion.json", "--f", F, "--xi", XI)
    screen = said(capsys, *asked)
    assert "100 ground motions of 19 earthquakes" in screen
    assert bool(SHARE.search(screen)) == (position != "outside")
    assert ("What it is asked for lies" in screen) == (position != "inside")
    tolerance = json.loads(said(capsys, *asked, "--json", "-"))["design"][0]
    assert (tolerance["position"], tolerance["confidence"]) == (
        position,
        None if position == "outside" else 0.95,
    )


def test_the_object(case):
    position, folder = case
    criterion = Criterion.from_json((folder / "criterion.json").read_text(encoding="utf-8"))
    for shown in (repr(criterion), criterion._repr_html_()):
        assert ("no stated share" in shown) == (position == "outside")
        assert bool(SHARE.search(shown)) == (position != "outside")


@pytest.mark.parametrize("criterion", ["that ships", "of the motion"])
def test_the_verdict(case, criterion, capsys):
    position, folder = case
    own = () if criterion == "that ships" else ("--criterion", folder / "criterion.json")
    content = json.loads(
        said(capsys, "assess", folder / "test.csv", "--f", F, "--xi", XI, "--json", "-", "--exact", *own)
    )
    assert (content["confidence"] is None) == (position == "outside")
    if criterion == "that ships":
        assert content["scope"]["position"] == position
    if position == "outside":
        assert content["by_index"]["verdict"] == "undecided"


def test_the_report_of_a_test(case):
    position, folder = case
    found = reliab.assess(folder / "test.csv", f=F, xi=XI, exact=True)
    facts = " ".join(str(fact) for fact in assessment_report(found, provenance={}).facts.values())
    assert f"with the test {position} of them" in facts
    assert ("no share of motions like the 100 ground motions" in facts) == (position == "outside")
