"""`reliab criterion` for several shares of the stiffness, and for frames with the rigs that they describe."""

import json

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from reliab.app.cli.criterion import criterion
from reliab.core.errors import InputError
from reliab.criterion.experimental_share import growth
from reliab.motions.catalogue import write_suite
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.simulation.frames.frame_file import read_frame
from reliab.sweep.frame_table import errors_of_rig
from reliab.tracking.indices.window import Window

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


@pytest.mark.slow
def test_the_error_of_the_described_rig_stands_beside_the_criterion(records, tmp_path):
    (tmp_path / "frame.toml").write_text(FRAME.format(delay=4.0))
    arguments = ("--motions", records, "--structure", tmp_path / "frame.toml")
    rig = answer(*arguments, "--threshold", "0.02")["rig"]
    frame = read_frame(tmp_path / "frame.toml")
    errors = errors_of_rig(frame, load_motions(str(records)), window=Window())["rms"]
    assert rig["stable"] is True
    assert rig["threshold"] == 0.02
    assert rig["largest"] == pytest.approx(errors.max())
    assert rig["share_below"] == pytest.approx(float((errors < 0.02).mean()))
    assert all(motion["d_ms"] == pytest.approx(4.0, rel=0.1) for motion in rig["motions"])
    output = run(*arguments, "--method", "quantile", "--confidence", "0.5").stdout
    assert f"{100 * errors.max():.2f} %" in output


@pytest.mark.slow
def test_an_unstable_rig_is_reported(records, tmp_path):
    (tmp_path / "frame.toml").write_text(FRAME.format(delay=60.0))
    arguments = ("--motions", records, "--structure", tmp_path / "frame.toml")
    assert answer(*arguments)["rig"]["stable"] is False
    assert "unstable" in run(*arguments, "--method", "quantile", "--confidence", "0.5").stdout


TWO_ACTUATORS = """
name = "two alike"
[frame]
names = ["left", "right"]
mass_matrix_kg = [[2000.0, 0.0], [0.0, 2000.0]]
stiffness_matrix_n_per_m = [[3e5, 0.0], [0.0, 3e5]]
[damping]
ratio = 0.05
[specimen]
degrees_of_freedom = ["left", "right"]
stiffness_matrix_n_per_m = [[1.5e5, 0.0], [0.0, 1.5e5]]
[transfer_system]
gain = 0.98
delay_ms = {delay}
"""


def test_two_like_actuators_have_the_criterion_and_the_rig_of_one(records, tmp_path):
    (tmp_path / "one.toml").write_text(FRAME.format(delay=4.0))
    (tmp_path / "two.toml").write_text(TWO_ACTUATORS.format(delay=4.0))
    item, second_answer, first = (
        answer("--motions", records, "--structure", tmp_path / name, *extra)
        for name, *extra in (("one.toml",), ("two.toml",), ("two.toml", "--actuator", "1"))
    )
    for content in (second_answer, first):
        for limit in ("a", "b"):
            assert content["criteria"][0][limit] == pytest.approx(item["criteria"][0][limit], rel=5e-3)
        assert content["rig"]["largest"] == pytest.approx(item["rig"]["largest"], rel=1e-3)
    assert second_answer["frame"] == {
        "name": "two alike",
        "error_of": "the interface displacement whose error is largest",
        "erring_actuator": "all alike",
    }
    assert first["frame"]["erring_actuator"] == 1
    assert "cross_coupling" not in first
    # a motion by the other one's command, which is the same here, is a gain error
    (own_coupling, limit), (second, _) = second_answer["cross_coupling"]["limits"]
    assert own_coupling is None
    assert limit == pytest.approx(second)
    assert limit == pytest.approx(item["criteria"][0]["amplitude_limit"], rel=0.1)
    arguments = ("--motions", records, "--structure", tmp_path / "two.toml", "--actuator", "1")
    output = run(*arguments, "--method", "quantile", "--confidence", "0.5").stdout
    assert "A and d of actuator 1; others are perfect." in " ".join(output.split())


@pytest.mark.parametrize(
    ("frame", "actuator", "rule"),
    [
        (TWO_ACTUATORS, 3, "the structure has 2"),
        (TWO_ACTUATORS, 0, "the structure has 2"),
        (FRAME, 2, "the structure has 1"),
        (None, 1, "needs the `structure` of a frame"),
    ],
)
def test_an_actuator_must_drive_the_frame(records, tmp_path, frame, actuator, rule):
    (tmp_path / "frame.toml").write_text((frame or FRAME).format(delay=4.0))
    options = () if frame is None else ("--structure", tmp_path / "frame.toml")
    result = run("--motions", records, *options, "--actuator", actuator)
    assert isinstance(result.exception, InputError)
    assert rule in str(result.exception)


def test_diverging_actuators_are_reported(records, tmp_path):
    (tmp_path / "two.toml").write_text(TWO_ACTUATORS.format(delay=60.0))
    assert answer("--motions", records, "--structure", tmp_path / "two.toml")["rig"]["stable"] is False


@pytest.mark.slow
def test_criteria_of_several_shares_grow_by_their_law(records):
    shares = ("--alpha", "1", "--alpha", "0.1")
    arguments = ("--motions", records, "--f", "1", "--xi", "0.02", "--alpha", "0.5")
    content = answer(*arguments, *shares)
    assert [row["alpha"] for row in content["criteria"]] == [0.1, 0.5, 1.0]
    single = answer(*arguments)
    assert single["criteria"] == content["criteria"][1:2]
    half, complete = (content["criteria"][place]["a"] for place in (1, 2))
    assert half / complete == pytest.approx(growth(0.5, 0.02), rel=0.3)
    output = run(*arguments, *shares, "--method", "quantile", "--confidence", "0.5", "--details").stdout
    assert "Share α of the stiffness in the laboratory: 0.1, 0.5, 1." in output


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.parametrize("extra", [("--figures", "figures"), ("--out", "criterion.json")])
def test_options_of_one_share_are_refused_for_several(records, tmp_path, monkeypatch, extra):
    monkeypatch.chdir(tmp_path)
    result = run("--motions", records, "--alpha", "0.5", "--alpha", "1", "--confidence", "0.5", *extra)
    assert isinstance(result.exception, InputError)
    assert "share" in str(result.exception)
