"""`reliab criterion` for several shares of the stiffness, and for a frame with its described rig."""

import json

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from reliab.cli.criterion import criterion
from reliab.errors import InputError
from reliab.indices.window import Window
from reliab.motions import Motion, MotionSuite, load_motions
from reliab.motions.writing import write_suite
from reliab.simulation.frames.frame_file import read_frame
from reliab.sweep.frame_table import errors_of_rig

app = typer.Typer()
app.command()(criterion)
FRAME = """
[frame]
masses_kg = [2000.0]
storey_stiffnesses_n_per_m = [3e5]
[damping]
ratio = 0.05
[specimen]
degree_of_freedom = "1"
stiffness_n_per_m = 1.5e5
[transfer_system]
gain = 0.98
delay_ms = {delay}
"""


def run(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def answer(*arguments):
    result = run(*arguments, "--method", "quantile", "--confidence", "0.5", "--json", "-")
    assert result.exception is None, result.exception
    return json.loads(result.stdout)


@pytest.fixture(scope="module")
def records(tmp_path_factory):
    rng = np.random.default_rng(5)
    folder = tmp_path_factory.mktemp("records")
    envelope = np.sin(np.linspace(0.0, np.pi, 400)) ** 2
    write_suite(
        MotionSuite.from_motions(
            Motion(
                name=f"E{k}/1", acceleration=rng.normal(size=400) * envelope, time_step=0.02, event=f"E{k}"
            )
            for k in range(3)
        ),
        folder,
    )
    return folder


def test_the_error_of_the_described_rig_stands_beside_the_criterion(records, tmp_path):
    (tmp_path / "frame.toml").write_text(FRAME.format(delay=4.0))
    given = ("--motions", records, "--structure", tmp_path / "frame.toml")
    rig = answer(*given, "--threshold", "0.02")["rig"]
    frame = read_frame(tmp_path / "frame.toml")
    errors = errors_of_rig(frame, load_motions(str(records)), window=Window())["rms"]
    assert rig["stable"] is True
    assert rig["threshold"] == 0.02
    assert rig["largest"] == pytest.approx(errors.max())
    assert rig["share_below"] == pytest.approx(float((errors < 0.02).mean()))
    assert all(motion["d_ms"] == pytest.approx(4.0, rel=0.1) for motion in rig["motions"])
    shown = run(*given, "--method", "quantile", "--confidence", "0.5").stdout
    assert f"{100 * errors.max():.2f} %" in shown


def test_a_described_rig_that_would_be_unstable_is_said_to_be(records, tmp_path):
    (tmp_path / "frame.toml").write_text(FRAME.format(delay=60.0))
    given = ("--motions", records, "--structure", tmp_path / "frame.toml")
    assert answer(*given)["rig"]["stable"] is False
    assert "unstable" in run(*given, "--method", "quantile", "--confidence", "0.5").stdout


def test_criteria_of_several_shares_stand_beside_their_law(records):
    shares = ("--alpha", "1", "--alpha", "0.1")
    given = ("--motions", records, "--f", "1", "--xi", "0.02", "--alpha", "0.5")
    content = answer(*given, *shares)
    assert [row["alpha"] for row in content["criteria"]] == [0.1, 0.5, 1.0]
    alone = answer(*given)
    assert alone["criteria"] == content["criteria"][1:2]
    assert "share_law" not in alone
    weak, half = content["share_law"]["ratios"]
    assert weak["law"] is None  # below ten damping ratios
    a, whole = (content["criteria"][place]["a"] for place in (1, 2))
    assert half["a_ratio"] == pytest.approx(a / whole)
    assert half["a_ratio"] == pytest.approx(half["law"], rel=0.3)
    shown = run(*given, *shares, "--method", "quantile", "--confidence", "0.5").stdout
    assert "Experimental fraction α: 0.1, 0.5, 1." in shown


@pytest.mark.parametrize("extra", [("--compare",), ("--figures", "figures"), ("--out", "criterion.json")])
def test_what_is_of_one_share_is_refused_for_several(records, tmp_path, monkeypatch, extra):
    monkeypatch.chdir(tmp_path)
    result = run("--motions", records, "--alpha", "0.5", "--alpha", "1", "--confidence", "0.5", *extra)
    assert isinstance(result.exception, InputError)
    assert "share" in str(result.exception)
