"""Generate a campaign: draw, simulate finely, add noise, write the product's format, return the label."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from blind_campaigns.case import COLUMNS, Case, Observation, root_mean_square
from blind_campaigns.catalogue import registry
from blind_campaigns.draws import Hidden, draw_campaign
from blind_campaigns.kinds import Kind, draw_kind
from blind_campaigns.labels import Label
from blind_campaigns.laboratory import Laboratory, nominal_stiffness
from blind_campaigns.march import FORWARD_EULER
from blind_campaigns.motions import RecordFolder
from blind_campaigns.noise import analogue, converted
from blind_campaigns.simulator import dropped_out, sensed, simulate_loop, simulate_prescribed
from blind_campaigns.system import Array, Effect, Rig

_VERDICTS = {
    Kind.NONE: "no_missing_effect",
    Kind.MISCALIBRATED: "no_missing_effect",
    Kind.OUTSIDE: "unknown_effect",
}


@dataclass(frozen=True, kw_only=True)
class Options:
    """What a batch of campaigns has in common; None means drawn at random."""

    kind: Kind | None = None
    effect: str | None = None
    observation: Observation | None = None
    noise_kind: str | None = None
    snr_db: float | None = None
    records: RecordFolder | None = None
    with_rivals: bool = True
    fed_back_noise: bool = False


def generate(seed: int, folder: Path, *, options: Options | None = None) -> Label:
    """Write the campaign of a seed into `folder` (named after it) and return its label.

    The same seed and options give the same bytes.
    """
    options = options or Options()
    streams = [np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(2)]
    kind = options.kind or draw_kind(streams[0])
    laboratory, hidden = draw_campaign(
        streams[0], kind, records=options.records, with_rivals=options.with_rivals,
        noise_kind=options.noise_kind, snr_db=options.snr_db, effect=options.effect,
        observation=options.observation,
    )  # fmt: skip
    folder.mkdir(parents=True, exist_ok=True)
    tests = _write_tests(streams[1], laboratory.case, folder, fed_back=options.fed_back_noise)
    marked = laboratory.case.held_out[-1] and streams[0].uniform() < 0.6
    (folder / "campaign.toml").write_text(
        _campaign_toml(folder.name, laboratory, tests, unmarked=marked), encoding="utf-8"
    )
    return _label(seed, folder.name, kind, laboratory, hidden, tests, fed_back=options.fed_back_noise)


def _write_tests(
    rng: np.random.Generator, case: Case, folder: Path, *, fed_back: bool
) -> list[dict[str, Any]]:
    """Simulate, corrupt and write all tests; return what the label says of each."""
    rows = []
    for number, (given, motion, out) in enumerate(zip(case.inputs, case.motions, case.held_out, strict=True)):
        columns, errors, signals = _recorded(rng, case, given, number, fed_back=fed_back)
        file = f"test_{number + 1:02d}.csv"
        _write_csv(folder / file, columns)
        rows.append(
            {
                "file": file,
                "motion": motion,
                "held_out": out,
                "peak_input": float(np.abs(given).max()),
                "noise_rms": {name: root_mean_square([error]) for name, error in errors.items()},
                "signal_rms": {name: root_mean_square([signal]) for name, signal in signals.items()},
            }
        )
    return rows


def _recorded(
    rng: np.random.Generator, case: Case, given: Array, number: int, *, fed_back: bool
) -> tuple[dict[str, Array], dict[str, Array], dict[str, Array]]:
    """Return the columns of one test, and noise and noise-free signal of the noisy ones."""
    hum = {
        name: analogue(rng, given.size, noise=case.noise, rms=rms, rate_hz=case.rate_hz)
        for name, rms in case.noise_rms.items()
    }
    if case.closed:
        noise = hum["force_n"] if fed_back else None
        run = simulate_loop(case.rig, given, rate_hz=case.rate_hz, feedback_noise=noise)
    else:
        run = simulate_prescribed(case.rig, given, rate_hz=case.rate_hz)
    measured, force = sensed(case.rig, run, case.rate_hz)
    clean = {"measured_m": measured, "force_n": force}
    noisy = {
        name: converted(clean[name] + hum[name], noise=case.noise, rms=case.noise_rms[name]) for name in clean
    }
    errors = {name: noisy[name] - clean[name] for name in clean if name in COLUMNS[case.observation]}
    noisy["measured_m"] = dropped_out(case.rig, noisy["measured_m"], case.rate_hz, number)
    everything = {
        "ground_acceleration_mps2": given,
        "command_m": run.command,
        **noisy,
    }
    columns = {name: everything[name] for name in COLUMNS[case.observation]}
    return (
        {"time_s": np.arange(given.size) / case.rate_hz, **columns},
        errors,
        {name: clean[name] for name in errors},
    )


def _write_csv(path: Path, columns: dict[str, Array]) -> None:
    """Write columns with twelve digits: the steps in the data are the converter's, not the format's."""
    texts = [[format(value, ".12g") for value in values.tolist()] for values in columns.values()]
    lines = [",".join(columns), *map(",".join, zip(*texts, strict=True))]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def _table(name: str, entries: dict[str, Any]) -> list[str]:
    return [f"[{name}]", *(f"{key} = {json.dumps(value)}" for key, value in entries.items()), ""]


def _campaign_toml(name: str, laboratory: Laboratory, tests: list[dict[str, Any]], *, unmarked: bool) -> str:
    """Return what the operator believes; `unmarked` leaves the last test to be held out by default."""
    case, believed = laboratory.case, laboratory.believed
    lines = [f"name = {json.dumps(name)}", ""]
    if believed.structure is not None:
        structure = {key: value for key, value in _structure_table(believed).items() if value is not None}
        lines += _table("structure", structure)
    if case.observation not in {Observation.SPECIMEN_ONLY, Observation.ONE_CHANNEL_OSCILLATOR}:
        lines += _table("actuator", {"gain": believed.actuator.gain, "delay_s": believed.actuator.delay_s})
    if believed.specimen is not None:
        specimen = believed.specimen
        lines += _table(
            "specimen",
            {
                "stiffness_n_per_m": specimen.stiffness_n_per_m,
                "damping_n_s_per_m": specimen.damping_n_s_per_m,
                "mass_kg": specimen.mass_kg,
            },
        )
    lines += _table("sampling", {"rate_hz": int(case.rate_hz)})
    for test in tests:
        entries = {
            "file": test["file"],
            "motion": test["motion"],
            "held_out": test["held_out"] and not unmarked,
        }
        lines += _table("[tests]", entries)
    return "\n".join(lines)


def _structure_table(rig: Rig) -> dict[str, Any]:
    structure = rig.structure
    return {
        "frequency_hz": structure.frequency_hz,
        "damping_ratio": structure.damping_ratio,
        "mass_kg": structure.mass_kg,
        "experimental_fraction": structure.experimental_fraction,
    }


def _label(
    seed: int, name: str, kind: Kind, laboratory: Laboratory, hidden: list[Hidden],
    tests: list[dict[str, Any]], *, fed_back: bool,
) -> Label:  # fmt: skip
    case, believed = laboratory.case, laboratory.believed
    noise = case.noise
    return Label(
        campaign=name,
        seed=seed,
        kind=str(kind),
        verdict=_VERDICTS.get(kind, "named"),
        observation=str(case.observation),
        effects=[_effect_entry(one, case) for one in hidden],
        calibration=_calibration(case.rig, believed),
        structure=None if believed.structure is None else _structure_table(believed),
        specimen=None if case.rig.specimen is None else asdict(case.rig.specimen),
        noise={
            "kind": noise.kind,
            "shares": noise.shares,
            "mains_hz": noise.mains_hz,
            "snr_db": laboratory.snr_db,
            "rms": {key: rms for key, rms in case.noise_rms.items() if key in COLUMNS[case.observation]},
            "fed_back": fed_back,
        },
        tests=tests,
        rate_hz=case.rate_hz,
    )


def _calibration(true: Rig, believed: Rig) -> dict[str, Any]:
    """Return true over nominal values of what may be miscalibrated."""
    stiffness = None if true.specimen is None else true.specimen.stiffness_n_per_m
    return {
        "gain": {"true": true.actuator.gain, "nominal": believed.actuator.gain},
        "delay_s": {"true": true.actuator.delay_s, "nominal": believed.actuator.delay_s},
        "stiffness_n_per_m": None
        if stiffness is None
        else {"true": stiffness, "nominal": nominal_stiffness(believed)},
        "excitation_scale": true.excitation_scale,
    }


def _effect_entry(hidden: Hidden, case: Case) -> dict[str, Any]:
    effect = hidden.effect
    units = registry()[effect.name].units
    return {
        "name": effect.name,
        "block": effect.block,
        "channel": effect.channel,
        "in_library": hidden.in_library,
        "parameters": {
            key: {"value": value, "units": units[key]} for key, value in effect.parameters.items()
        },
        "derived": _derived(effect, case),
        "effect_to_noise_db": round(hidden.ratio_db, 2),
        "joint_effect_to_noise_db": round(hidden.joint_db, 2),
        "nats": round(hidden.nats, 1),
        "unexplained_db": round(hidden.unexplained_db, 2),
        "rivals": hidden.rivals,
        "degenerate_with": hidden.degenerate_with,
        "mimicked_by": hidden.mimicked_by,
    }


def _derived(effect: Effect, case: Case) -> dict[str, float]:
    """Return the numerical damping ratio of a coarse integration, to leading order."""
    if effect.name != "integration_error":
        return {}
    turn = case.rig.structure.omega * effect.parameters["step_s"]
    if effect.parameters["scheme"] == FORWARD_EULER:
        return {"numerical_damping_ratio": -0.5 * turn}
    return {"numerical_damping_ratio": 0.5 * (effect.parameters["newmark_gamma"] - 0.5) * turn}
