"""Draw a laboratory: structure, actuator, specimen, inputs, noise, and what the operator believes."""

import math
from dataclasses import dataclass, replace

import numpy as np

from blind_campaigns.case import OPEN_LOOP, Case, Observation, root_mean_square
from blind_campaigns.catalogue import Scales, scales_of
from blind_campaigns.motions import RecordFolder, chirp, multisine, synthetic_accelerogram
from blind_campaigns.noise import KINDS, draw_noise
from blind_campaigns.simulator import FINEST_HZ, simulate_loop, substeps
from blind_campaigns.system import Actuator, Array, Rig, Specimen, Structure

_COARSE_HZ = 1024.0
_USUAL_TESTS, _USUAL_SECONDS = 5, 45.0


@dataclass(frozen=True, kw_only=True)
class Laboratory:
    """A campaign without hidden effects: what is true, and what the operator believes."""

    case: Case
    believed: Rig
    snr_db: float
    scales: Scales


@dataclass(frozen=True, kw_only=True)
class Wishes:
    """What a drawn laboratory must respect."""

    observation: Observation
    miscalibrated: bool = True
    massless_specimen: bool = False
    noise_kind: str | None = None
    snr_db: float | None = None
    records: RecordFolder | None = None


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a log-uniform number."""
    return float(low * (high / low) ** rng.uniform())


def draw_laboratory(rng: np.random.Generator, wishes: Wishes) -> Laboratory:
    """Return a random laboratory whose loop is stable without effects."""
    believed, rig = _draw_rigs(rng, wishes)
    rate = float(rng.choice([1024.0, 1024.0, 1024.0, 1024.0, 512.0, 1000.0, 2000.0, 2048.0]))
    motions, inputs = _draw_inputs(rng, wishes, rig, rate)
    count = len(inputs)
    held_out = [False] * count
    held_out[-1 if rng.uniform() < 0.75 else int(rng.integers(count))] = True
    kind = wishes.noise_kind or str(rng.choice(KINDS))
    snr = wishes.snr_db if wishes.snr_db is not None else float(rng.uniform(20.0, 50.0))
    case = Case(
        rig=rig, observation=wishes.observation, rate_hz=rate, inputs=tuple(inputs), motions=tuple(motions),
        held_out=tuple(held_out), numbers=tuple(range(count)), noise=draw_noise(rng, kind), noise_rms={},
    )  # fmt: skip
    responses = case.run(_COARSE_HZ)
    share = 10.0 ** (-snr / 20.0)
    floor = {
        "measured_m": share * root_mean_square([response.piston for response in responses]),
        "force_n": share * root_mean_square([response.force for response in responses]),
    }
    case = replace(case, noise_rms=floor)
    return Laboratory(case=case, believed=believed, snr_db=snr, scales=_scales(case))


def _scales(case: Case) -> Scales:
    training = case.training
    responses = training.run(_COARSE_HZ)
    specimen = case.rig.specimen
    return scales_of(
        pistons=[response.piston for response in responses],
        velocities=[response.velocity for response in responses],
        forces=[response.force for response in responses],
        stiffness=1.0 if specimen is None else specimen.stiffness_n_per_m,
        delay=case.rig.actuator.delay_s,
        duration=min(given.size for given in training.inputs) / case.rate_hz,
        integration_step=1.0 / (case.rate_hz * substeps(case.rate_hz, FINEST_HZ)),
    )


def _draw_rigs(rng: np.random.Generator, wishes: Wishes) -> tuple[Rig, Rig]:
    """Return what is believed and what is true."""
    observation = wishes.observation
    structure = None if observation in OPEN_LOOP else _draw_structure(rng, observation)
    specimen, own = _draw_specimen(rng, structure, wishes)
    if observation is Observation.ACTUATOR_ONLY:
        specimen = None
    without_actuator = observation in {Observation.SPECIMEN_ONLY, Observation.ONE_CHANNEL_OSCILLATOR}
    actuator, believed_actuator = (Actuator(), Actuator())
    if not without_actuator:
        actuator, believed_actuator = _draw_actuator(rng, structure)
    believed = Rig(structure=structure, actuator=believed_actuator, specimen=specimen)
    rig = replace(believed, actuator=actuator) if wishes.miscalibrated else believed
    if wishes.miscalibrated and specimen is not None:
        true = replace(specimen, stiffness_n_per_m=specimen.stiffness_n_per_m * rng.uniform(0.91, 1.09))
        rig = replace(rig, specimen=true)
    if wishes.miscalibrated and observation is Observation.ONE_CHANNEL_OSCILLATOR:
        rig = replace(rig, excitation_scale=float(rng.uniform(0.9, 1.1)))
    return (replace(believed, specimen=None) if own else believed), rig


def _draw_structure(rng: np.random.Generator, observation: Observation) -> Structure:
    whole = observation is Observation.ONE_CHANNEL_OSCILLATOR or rng.uniform() < 0.4
    return Structure(
        frequency_hz=round(log_uniform(rng, 0.3, 3.0), 3),
        damping_ratio=round(log_uniform(rng, 0.01, 0.1), 4),
        mass_kg=None if rng.uniform() < 0.15 else float(f"{log_uniform(rng, 1.0, 1e5):.4g}"),
        experimental_fraction=1.0 if whole else round(float(rng.uniform(0.3, 1.0)), 3),
    )


def _draw_specimen(
    rng: np.random.Generator, structure: Structure | None, wishes: Wishes
) -> tuple[Specimen, bool]:
    """Return the nominal specimen, and whether it is the structure's own spring."""
    if structure is None:
        damping = 0.0
        stiffness = float(f"{log_uniform(rng, 1e4, 1e8):.4g}")
        return Specimen(stiffness_n_per_m=stiffness, damping_n_s_per_m=damping), False
    own = Specimen(stiffness_n_per_m=structure.own_spring)
    if wishes.observation is Observation.ONE_CHANNEL_OSCILLATOR or rng.uniform() < 0.75:
        return own, True
    critical = 2.0 * structure.omega * structure.mass
    damping = 0.0 if rng.uniform() < 0.5 else critical * rng.uniform(0.003, 0.02)
    light = wishes.massless_specimen or rng.uniform() < 0.7
    mass = 0.0 if light else structure.mass * rng.uniform(0.005, 0.03)
    stiffness = structure.own_spring * rng.uniform(0.7, 1.3)
    numbers = [float(f"{number:.5g}") for number in (stiffness, damping, mass)]
    return Specimen(stiffness_n_per_m=numbers[0], damping_n_s_per_m=numbers[1], mass_kg=numbers[2]), False


def _draw_actuator(rng: np.random.Generator, structure: Structure | None) -> tuple[Actuator, Actuator]:
    """Return the true and the believed actuator; delays up to 20 ms that leave half of the loop's damping."""
    limit = 0.02
    if structure is not None:
        limit = min(limit, structure.damping_ratio / (structure.experimental_fraction * structure.omega))
    true = Actuator(gain=float(rng.uniform(0.97, 1.03)), delay_s=float(rng.uniform(0.0, limit)))
    error = min(0.002, 0.4 * limit)
    delay = min(max(true.delay_s + rng.uniform(-error, error), 0.0), 1.2 * limit)
    gain = 1.0 if rng.uniform() < 0.8 else round(true.gain + float(rng.uniform(-0.015, 0.015)), 3)
    return true, Actuator(gain=gain, delay_s=round(float(delay), 5))


def _draw_inputs(
    rng: np.random.Generator, wishes: Wishes, rig: Rig, rate: float
) -> tuple[list[str], list[Array]]:
    """Return names and inputs of all tests: five of 45 s as a rule, different motions and amplitudes."""
    count, seconds = _USUAL_TESTS, _USUAL_SECONDS
    if rng.uniform() > 0.6:
        count, seconds = int(rng.integers(3, 7)), float(rng.uniform(20.0, 60.0))
    relative = rng.permutation(np.append(rng.uniform(0.4, 1.0, count - 1), 1.0))
    if wishes.observation in OPEN_LOOP:
        return _draw_commands(rng, wishes, relative, seconds, rate)
    structure = rig.structure
    peak = min(log_uniform(rng, 0.005, 0.15), 15.0 / structure.omega**2)
    names, inputs = [], []
    for number, share in enumerate(relative, start=1):
        name, motion = _ground(rng, wishes.records, number, seconds, rate)
        reach = np.abs(simulate_loop(rig, motion, rate_hz=rate, finest_hz=_COARSE_HZ).piston).max()
        names.append(name)
        inputs.append(motion * (share * peak / reach))
    return names, inputs


def _ground(
    rng: np.random.Generator, records: RecordFolder | None, number: int, seconds: float, rate: float
) -> tuple[str, Array]:
    if records is not None:
        return records.draw(rng, duration_s=seconds, rate_hz=rate)
    return f"synthetic/{number:02d}", synthetic_accelerogram(rng, duration_s=seconds, rate_hz=rate)


def _draw_commands(
    rng: np.random.Generator, wishes: Wishes, relative: Array, seconds: float, rate: float
) -> tuple[list[str], list[Array]]:
    """Return commands of one kind or mixed: displacements of earthquakes, sweeps, multisines."""
    sort = rng.choice(["earthquake", "chirp", "multisine", "mixed"], p=[0.35, 0.25, 0.15, 0.25])
    peak = log_uniform(rng, 0.001, 0.005) if sort in {"chirp", "mixed"} else log_uniform(rng, 0.005, 0.05)
    names, inputs = [], []
    for number, share in enumerate(relative, start=1):
        one = str(rng.choice(["earthquake", "chirp", "multisine"])) if sort == "mixed" else str(sort)
        if one == "chirp":
            wave = chirp(rng, duration_s=seconds, rate_hz=rate)
        elif one == "multisine":
            wave = multisine(rng, duration_s=seconds, rate_hz=rate)
        else:
            structure = _draw_structure(rng, Observation.ACTUATOR_ONLY)
            spring = Specimen(stiffness_n_per_m=structure.omega**2 * structure.mass)
            oscillator = Rig(structure=replace(structure, experimental_fraction=1.0), specimen=spring)
            ground = _ground(rng, wishes.records, number, seconds, rate)[1]
            wave = simulate_loop(oscillator, ground, rate_hz=rate, finest_hz=_COARSE_HZ).piston
            wave = wave / np.abs(wave).max()
        names.append(f"{one}/{number:02d}")
        inputs.append(wave * share * peak)
    return names, inputs


def nominal_stiffness(believed: Rig) -> float:
    """Return the specimen stiffness that the operator believes in [N/m]."""
    if believed.specimen is not None:
        return believed.specimen.stiffness_n_per_m
    return math.nan if believed.structure is None else believed.structure.own_spring
