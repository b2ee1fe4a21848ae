"""The updated model survives its file, and what breaks a rule is explained."""

import json

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

from reliab.app.api.sources import ellipses
from reliab.app.cli import application
from reliab.core.errors import InputError
from reliab.effects.registry import find_effect, library
from reliab.motions.loading import load_motions
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel, read_model, write_model
from reliab.structures.frame import Specimen
from reliab.structures.structure import Structure
from reliab.sweep.results import open_results

STRUCTURE = Structure(frequency=1.3, damping_ratio=0.03, experimental_fraction=0.7)


def example(name):
    kind = library()[name]
    return kind(**{parameter.name: 0.1 + 0.01 * k for k, parameter in enumerate(kind.parameters)})


@pytest.mark.parametrize("name", list(library()))
def test_every_effect_comes_back(tmp_path, name):
    effect = example(name)
    deviations = {f"{name}.{parameter.name}": 1e-3 for parameter in effect.parameters}
    text = UpdatedModel(
        name="a test", test=HybridTest(structure=STRUCTURE, effects=(effect,)), deviations=deviations
    )
    write_model(tmp_path / "model.toml", text)
    assert read_model(tmp_path / "model.toml") == text


@pytest.mark.parametrize(
    "test",
    [
        HybridTest(),
        HybridTest(specimen=Specimen(stiffness=1e5, damping=-3.0, mass=1.5)),
        HybridTest(structure=STRUCTURE, mass=2e4, actuator=Actuator(gain=1.0 / 3.0, delay=1e-17)),
        HybridTest(structure=STRUCTURE, effects=(example("gap"), example("first_order_lag"))),
    ],
)
def test_every_digit_comes_back(tmp_path, test):
    text = UpdatedModel(
        name='"quoted" \\ ünïcode\n\x7f\x01', test=test, deviations={"gain": 1e-4, "delay_s": 2.0 / 3.0}
    )
    write_model(tmp_path / "model.toml", text)
    assert read_model(tmp_path / "model.toml") == text


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("frequency_hz = 1.3", "frequency_hz = -1.3", r"frequency_hz: the natural .*, not -1\.3"),
        ("frequency_hz = 1.3", "frequency = 1.3", r"frequency_hz is missing"),
        ("damping_ratio = 0.03", "damping_ratio = nan", r"Not a finite number; found nan"),
        ("format = 1", "format = 1\ncolour = 3", r"colour is not a known key"),
        ('name = "coulomb_friction"', 'name = "coulomb"', r"Unknown effect; found coulomb.*coulomb_friction"),
        ("[effects.parameters.force_n]", "[effects.parameters.force]", r"parameters of .* are force_n"),
        ('units = "N"', 'units = "kN"', r"unit of force_n is N; found 'kN'"),
        ("m_per_s]\nvalue = 0.11", "m_per_s]\nvalue = -1", r"must be positive"),
        ("sd = 0.001", "sd = -0.001", "must be 0 or positive"),
        ("format = 1", "format = 2", r"format"),
        ("format = 1", "format = ", r"readable TOML file"),
    ],
)  # fmt: skip
def test_broken_rules_are_named(tmp_path, old, new, match):
    path = tmp_path / "model.toml"
    friction = example("coulomb_friction")
    test = HybridTest(structure=STRUCTURE, effects=(friction,))
    write_model(path, UpdatedModel(name="", test=test, deviations={"coulomb_friction.force_n": 1e-3}))
    text = "\n".join(line.split("  #")[0] for line in path.read_text().splitlines())
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError, match=match):
        read_model(path)


@pytest.mark.parametrize("content", [None, b"\xff\xfe\x00"])
def test_missing_file_is_refused(tmp_path, content):
    path = tmp_path / "model.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=r"readable TOML file|model\.toml: No such file"):
        read_model(path)


def test_a_folder_cannot_be_written_as_a_file(tmp_path):
    with pytest.raises(InputError, match="Cannot write"):
        write_model(tmp_path, UpdatedModel(name="", test=HybridTest()))


def command(*arguments):
    return CliRunner().invoke(application(), [str(argument) for argument in arguments])


@pytest.fixture
def motions(tmp_path):
    rng = np.random.default_rng(3)
    t = np.arange(0.0, 15.0, 0.02)
    for k in range(3):
        shaken = rng.standard_normal(t.size) * np.exp(-(((t - 5.0) / 3.0) ** 2))
        rows = "\n".join(f"{time:.2f},{a:.6f}" for time, a in zip(t, shaken, strict=True))
        (tmp_path / f"motion_{k}.csv").write_text(f"time_s,acceleration_mps2\n{rows}\n")
    return tmp_path


@pytest.mark.slow
def test_commands_take_the_model(motions):
    lag = find_effect("first_order_lag")(time_constant_s=0.0005)
    model = motions / "model.toml"
    write_model(model, UpdatedModel(name="late", test=HybridTest(structure=STRUCTURE, effects=(lag,))))
    records = sorted(motions.glob("*.csv"))
    shared = [option for record in records for option in ("--motions", record)]
    shared += ["--confidence", 0.5]  # three earthquakes carry no more than three quarters
    lagging = command("criterion", *shared, "--model", model, "--json", "-")
    assert lagging.exit_code == 0
    structure = ("--f", "1.3", "--xi", "0.03", "--alpha", "0.7")
    bare = command("criterion", *shared, *structure, "--json", "-")
    result, linear = json.loads(lagging.stdout), json.loads(bare.stdout)
    assert (result["f"], result["xi"]) == (1.3, 0.03)
    assert 0.0 < result["b"] < 0.9 * linear["b"]
    both = command("criterion", *shared, "--model", model, *structure)
    assert isinstance(both.exception, InputError)
    assert "contains its structure" in str(both.exception)


@pytest.mark.slow
def test_a_model_is_simulated_and_stored(motions):
    lag = find_effect("first_order_lag")(time_constant_s=0.0005)
    model, store = motions / "model.toml", motions / "results.zarr"
    write_model(model, UpdatedModel(name="late", test=HybridTest(structure=STRUCTURE, effects=(lag,))))
    process = command(
        "simulate", "--motions", motions / "motion_0.csv", "--model", model, "--out", store, "--grid", "paper"
    )
    assert process.exit_code == 0
    assert "first_order_lag" in open_results(store).attrs["model"]
    archive = command("ellipses", "--results", store, "--threshold", "0.02", "--json", "-")
    boundary = command(
        "ellipses",
        "--motions",
        motions / "motion_0.csv",
        "--model",
        model,
        "--threshold",
        "0.02",
        "--json",
        "-",
    )
    (single,), (second,) = (json.loads(item.stdout)["ellipses"] for item in (archive, boundary))
    assert single["b"] == pytest.approx(second["b"], rel=0.01)
    assert single["a"] == pytest.approx(second["a"], rel=0.01)


@pytest.mark.slow
def test_python_and_command_line_simulate_the_same(motions):
    lag = find_effect("first_order_lag")(time_constant_s=0.0005)
    test = HybridTest(structure=STRUCTURE, effects=(lag,))
    write_model(motions / "model.toml", UpdatedModel(name="late", test=test))
    suite = load_motions(motions / "motion_0.csv")
    file_values = ellipses(suite, model=motions / "model.toml")
    xr.testing.assert_identical(file_values, ellipses(suite, model=test))
    assert file_values["f"].item() == STRUCTURE.frequency
    with pytest.raises(InputError, match="contains its structure"):
        ellipses(suite, f=[1.0], model=test)
    with pytest.raises(InputError, match="numerical substructure"):
        ellipses(suite, model=HybridTest(effects=(lag,)))


def test_effects_exceeding_the_threshold_are_reported(motions):
    lag = find_effect("first_order_lag")(time_constant_s=0.02)
    model = motions / "model.toml"
    write_model(model, UpdatedModel(name="late", test=HybridTest(structure=STRUCTURE, effects=(lag,))))
    shared = [option for record in sorted(motions.glob("*.csv")) for option in ("--motions", record)]
    process = command("criterion", *shared, "--model", model)
    assert isinstance(process.exception, InputError)
    assert "3 of 3 motions" in str(process.exception)
