"""Campaigns of frames: read, balanced, and diagnosed where code that shares nothing hid an effect."""

import frame_laboratory
import numpy as np
import pytest
from scipy import integrate

from reliab.core.errors import InputError
from reliab.discrepancy.adding import update_model
from reliab.discrepancy.blocks.balance import motion_of_command
from reliab.discrepancy.campaign.campaign import Channel
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.result.diagnosis import Diagnosis
from reliab.simulation.hybrid_test.model_file import read_model, write_model
from reliab.structures.inner_motion import InnerMotion
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

FRAME = """[structure.frame]
masses_kg = [1000.0, 1000.0]
storey_stiffnesses_n_per_m = [4e5, 3e5]
[structure.damping]
ratio = 0.02
[structure.specimen]
degree_of_freedom = 1
stiffness_n_per_m = 1e5
"""


def write_frame(folder, structure, extra=""):
    """Give a small campaign another structure."""
    text = (folder / "campaign.toml").read_text(encoding="utf-8")
    tail = text[text.index("[actuator]") :]
    (folder / "campaign.toml").write_text(f'name = "frame"\n{structure}{extra}{tail}', encoding="utf-8")
    return read_campaign(folder)


def test_a_frame_is_read_with_its_interface_and_specimen(small_campaign):
    campaign = write_frame(small_campaign, FRAME)
    assert campaign.structure is None
    np.testing.assert_array_equal(campaign.partition.direction, [1.0, 0.0])
    np.testing.assert_array_equal(campaign.partition.frame.stiffness, [[7e5, -3e5], [-3e5, 3e5]])
    assert campaign.nominal.specimen.stiffness == 1e5


def test_model_of_a_frame_says_so_in_its_file(small_campaign, tmp_path):
    nothing_seen = Diagnosis(campaign=write_frame(small_campaign, FRAME), blocks=())
    write_model(tmp_path / "model.toml", update_model(nothing_seen))
    model = read_model(tmp_path / "model.toml")
    assert model.test.structure is None
    assert model.test.specimen.stiffness == 1e5
    assert "the frame of these tests is described in their campaign.toml" in (
        tmp_path / "model.toml"
    ).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("structure", "extra", "rule"),
    [
        (FRAME, "[specimen]\nstiffness_n_per_m = 1.0\n", "described in .structure.specimen."),
        (FRAME.replace("degree_of_freedom = 1", "degree_of_freedom = 5"), "", "degree of freedom"),
        (FRAME.replace("1e5", "9e5"), "", "must not have a negative stiffness"),
        (FRAME.replace("ratio = 0.02", "ratio = 0.02\nratios = [0.1, 0.1]"), "", "known keys"),
        ("[structure]\nfrequency_hz = 1.0\n" + FRAME, "", r"structure\.frequency_hz is not a known key"),
        (
            FRAME + '[[structure.specimen.effects]]\nname = "cubic_stiffness"\ncubic_n_per_m3 = 1.0\n',
            "",
            "nominal specimen of a campaign must be linear",
        ),
    ],
)
def test_unsound_frame_is_refused(small_campaign, structure, extra, rule):
    with pytest.raises(InputError, match=rule):
        write_frame(small_campaign, structure, extra)


def test_ground_and_reading_alone_show_no_block_of_a_frame(small_campaign):
    for file in ("a.csv", "b.csv"):
        text = (small_campaign / file).read_text(encoding="utf-8")
        (small_campaign / file).write_text(
            text.replace("command_m", "ground_acceleration_mps2"), encoding="utf-8"
        )
    with pytest.raises(InputError, match="one degree of freedom"):
        diagnose(write_frame(small_campaign, FRAME))


def test_one_mass_balances_by_its_equation_of_motion():
    structure = Structure(frequency=1.3, damping_ratio=0.04, experimental_fraction=0.6)
    partition = Partition.from_structure(structure, mass=20.0)
    random = np.random.default_rng(3)
    ground, motion = random.normal(size=50), random.normal(size=(3, 50))
    w0 = structure.circular_frequency
    balance = motion[2] + 2.0 * 0.04 * w0 * motion[1] + 0.4 * w0**2 * motion[0] + ground
    np.testing.assert_allclose(
        InnerMotion(partition, 0.01).force(ground, motion), -20.0 * balance, rtol=1e-12
    )


def test_a_smooth_motion_of_the_interface_needs_the_force_of_the_differential_equation(small_campaign):
    partition = write_frame(small_campaign, FRAME).partition
    mass, damping, stiffness = (
        partition.numerical_mass,
        partition.numerical_damping,
        partition.numerical_stiffness,
    )

    def moved(time):
        """Displacement, velocity and acceleration of the first floor, a sine that rises from rest."""
        rise, angle = 1.0 - np.exp(-(time**4)), 15.0 * time
        slope = 4.0 * time**3 * np.exp(-(time**4))
        bend = (12.0 * time**2 - 16.0 * time**6) * np.exp(-(time**4))
        return np.stack(
            [
                rise * np.sin(angle),
                slope * np.sin(angle) + 15.0 * rise * np.cos(angle),
                bend * np.sin(angle) + 30.0 * slope * np.cos(angle) - 225.0 * rise * np.sin(angle),
            ]
        )

    def speed(time, state):
        x, v, a = moved(time)
        load = mass[1, 0] * a + damping[1, 0] * v + stiffness[1, 0] * x
        return [state[1], -(load + damping[1, 1] * state[1] + stiffness[1, 1] * state[0]) / mass[1, 1]]

    time = np.arange(0.0, 4.0, 0.01)
    inner = integrate.solve_ivp(speed, (0.0, 4.0), [0.0, 0.0], "DOP853", time, rtol=1e-10, atol=1e-12).y
    x, v, a = moved(time)
    second = np.array([speed(t, state)[1] for t, state in zip(time, inner.T, strict=True)])
    both = ((mass, (a, second)), (damping, (v, inner[1])), (stiffness, (x, inner[0])))
    reference = -sum(matrix[0] @ np.stack(history) for matrix, history in both)
    force = InnerMotion(partition, 0.01).force(np.zeros(time.size), np.stack([x, v, a]))
    np.testing.assert_allclose(force, reference, atol=1e-4 * np.abs(reference).max())


@pytest.mark.slow
def test_command_and_ground_give_the_force_of_an_independent_simulation(tmp_path):
    frame_laboratory.write_campaign(tmp_path, 4, "none", tests=2, noise=0.0)
    campaign = read_campaign(tmp_path)
    test = campaign.tests[0]
    motion = motion_of_command(test, campaign.step).values
    force = InnerMotion(campaign.partition, campaign.step).force(test.channels[Channel.GROUND], motion)
    np.testing.assert_allclose(
        force, test.channels[Channel.FORCE], atol=1e-4 * np.abs(test.channels[Channel.FORCE]).max()
    )


BLIND = [
    ("coulomb_friction", "specimen"),
    ("cubic_stiffness", "specimen"),
    ("first_order_lag", "actuator"),
    ("sensor_bias", "sensor"),
    ("excitation_scale", "excitation"),
]


WRONG_NAME = pytest.mark.xfail(
    reason="named second-order dynamics, whose transfer function is near that of a lag"
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effect", "block", "seed"),
    [
        pytest.param(
            effect, block, seed, marks=WRONG_NAME if (effect, seed) == ("first_order_lag", 12) else ()
        )
        for effect, block in BLIND
        for seed in (11, 12)
    ],
)
def test_an_effect_hidden_in_a_frame_is_named(tmp_path, effect, block, seed):
    frame_laboratory.write_campaign(tmp_path, seed, effect)
    result = diagnose(read_campaign(tmp_path)).to_dict()
    assert result["verdict"] == "named"
    assert [(effect_row["name"], effect_row["block"]) for effect_row in result["effects"]] == [
        (effect, block)
    ]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [13, 14])
def test_a_frame_without_a_hidden_effect_is_told_to_have_none(tmp_path, seed):
    frame_laboratory.write_campaign(tmp_path, seed, "none")
    assert diagnose(read_campaign(tmp_path)).to_dict()["verdict"] == "no_missing_effect"
