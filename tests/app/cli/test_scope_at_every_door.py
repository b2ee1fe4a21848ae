"""Every door says where a ground motion lies among those behind a criterion, and promises nothing outside."""

import json
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import reliab
from reliab.app import cli
from reliab.criterion.criterion import Criterion
from reliab.motions.loading import load_motions
from reliab.report.kinds.assessment.report import assessment_report
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop.spectral import respond

F, XI = 1.0, 0.02
MOTIONS = {"inside": 0, "at the edge": 10, "outside": 4}  # of the synthetic suite: 64, 86 and 102 s
TOO_SMALL = "of a share too small to be kept"
SHARES = {TOO_SMALL: 0.6}
USUAL = 0.95


@dataclass(frozen=True)
class Case:
    """A ground motion, a criterion for it, and a test that was run under it."""

    folder: Path
    position: str
    share: float

    @property
    def promised(self):
        """Share that the criterion promises."""
        return None if self.position == "outside" or self.share != USUAL else self.share

    def states(self, text):
        """Whether a text states the share."""
        return re.search(rf"\b{100 * self.share:g} ?%|\b{self.share:g}\b", text) is not None

    def asked(self, *options):
        """Ask for the criterion."""
        motion = self.folder / "motion.txt"
        return ("criterion", "--motion", motion, "--f", F, "--xi", XI, "--confidence", self.share, *options)


@pytest.fixture(
    scope="module",
    params=[
        *("outside", TOO_SMALL),
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("inside", "at the edge")),
    ],
)
def case(request, tmp_path_factory):
    """Where a motion lies, its record, a criterion for it, and a test that was run under it."""
    folder = tmp_path_factory.mktemp("doors")
    position = "inside" if request.param == TOO_SMALL else request.param
    result = Case(folder=folder, position=position, share=SHARES.get(request.param, USUAL))
    motion = load_motions("synthetic")[MOTIONS[position]]
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
    assert cli.run([str(part) for part in result.asked("--out", folder / "criterion.json")]) == 0
    return result


def output_of(capsys, *arguments):
    """What a command prints, words of one line each."""
    assert cli.run([str(argument) for argument in arguments]) in {0, 1}
    return " ".join(capsys.readouterr().out.split())


@pytest.mark.slow
def test_the_criterion(case, capsys):
    screen = output_of(capsys, *case.asked())
    assert ("The case asked for lies" in screen) == (case.position != "inside")
    assert ("No share below 80 % is promised" in screen) == (case.share < 0.8)
    content = json.loads(output_of(capsys, *case.asked("--json", "-")))
    assert (content["position"], content["confidence"]) == (case.position, case.promised)
    assert "100 ground motions of 19 earthquakes" in content["population"]
    table = screen.split("confidence [-]")[1].split("Method:")[0]
    assert case.states(table) == (case.promised is not None)
    output_of(capsys, *case.asked("--figures", case.folder / "figures"))
    (figure,) = (case.folder / "figures").glob("criterion_*.svg")
    drawing_text = figure.read_text(encoding="utf-8")
    assert ("no share promised" in drawing_text) == (case.promised is None)
    assert (f"{100 * case.share:g} % of motions" in drawing_text) == (case.promised is not None)


def test_the_design(case, capsys):
    arguments = ("design", "--criterion", case.folder / "criterion.json", "--f", F, "--xi", XI)
    screen = output_of(capsys, *arguments)
    assert "100 ground motions of 19 earthquakes" in screen
    assert case.states(screen) == (case.promised is not None)
    assert ("The case asked for lies" in screen) == (case.position != "inside")
    tolerance = json.loads(output_of(capsys, *arguments, "--json", "-"))["design"][0]
    assert (tolerance["position"], tolerance["confidence"]) == (case.position, case.promised)


def test_the_object(case):
    criterion = Criterion.from_json((case.folder / "criterion.json").read_text(encoding="utf-8"))
    for output in (repr(criterion), criterion._repr_html_()):
        assert ("no stated share" in output) == (case.promised is None)
        assert case.states(output) == (case.promised is not None)


@pytest.mark.parametrize("criterion", ["that ships", "of the motion"])
def test_the_verdict(case, criterion, capsys):
    criterion_options = () if criterion == "that ships" else ("--criterion", case.folder / "criterion.json")
    content = json.loads(
        output_of(
            capsys,
            "assess",
            case.folder / "test.csv",
            "--f",
            F,
            "--xi",
            XI,
            "--json",
            "-",
            "--exact",
            *criterion_options,
        )
    )
    if criterion == "that ships":
        assert content["scope"]["position"] == case.position
        assert (content["confidence"] is None) == (case.position == "outside")
    else:
        assert (content["confidence"] is None) == (case.promised is None)
    if content["confidence"] is None:
        assert content["by_index"]["verdict"] == "undecided"


def test_the_report_of_a_test(case):
    assessment = reliab.assess(case.folder / "test.csv", f=F, xi=XI, exact=True)
    facts = " ".join(str(fact) for fact in assessment_report(assessment, provenance={}).facts.values())
    assert f"with the test {case.position} of them" in facts
    assert ("no share of motions like these" in facts) == (case.position == "outside")


def test_the_comparison(case, capsys):
    """They are ranked by their own errors, of which no share of ground motions is said."""
    tests = [case.folder / name for name in ("test.csv", "again.csv")]
    tests[1].write_bytes(tests[0].read_bytes())
    screen = output_of(capsys, "compare", *tests, "--f", F, "--xi", XI, "--exact")
    assert "of motions" not in screen
    assert "ground motions" not in screen


def test_a_validation(case, capsys):
    motion_options = ("--motions", case.folder / "motion.txt", "--f", F, "--xi", XI, "--confidence", 0.95)
    screen = output_of(capsys, "validate", "--learn", "real_suite", *motion_options, "--trials", 8)
    is_outside = case.position == "outside"
    assert ("no share is promised" in screen) == is_outside
    verdict = re.search(r"dirichlet (keeps|may keep|does not keep) what it states", screen)
    assert (verdict is None) == is_outside
