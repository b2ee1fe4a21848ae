"""Draw what is hidden in a campaign: which effects, how large, and whether a judge could tell them."""

from dataclasses import dataclass, replace

import numpy as np

from blind_campaigns.case import ONE_CHANNEL, Case, Observation, decibels, root_mean_square
from blind_campaigns.catalogue import Definition, registry
from blind_campaigns.kinds import (
    INERTIAL_ENEMIES,
    Kind,
    draw_definitions,
    observations,
    one_channel_observations,
)
from blind_campaigns.laboratory import Laboratory, Wishes, draw_laboratory
from blind_campaigns.loop_refit import loop_residual
from blind_campaigns.motions import RecordFolder
from blind_campaigns.ratio import Change, calibrated_residual, effect_change, effect_to_noise, nats
from blind_campaigns.rivals import loop_rate, loop_rival_residuals, rival_residuals
from blind_campaigns.simulator import Response
from blind_campaigns.sizing import Sizing, believable, sized_effect
from blind_campaigns.system import Array, Effect

_COARSE_HZ = 1024.0
_ATTEMPTS = 60
_INDISTINGUISHABLE_NATS = 10.0


@dataclass(frozen=True, kw_only=True)
class Hidden:
    """One hidden effect and how clearly it shows.

    `ratio_db` after calibration; `joint_db` after the amplitudes of the other hidden effects of the channel
    are free as well; `nats` is what an ideal observer gains by the effect; `rivals` holds for each rival what
    it leaves (dB over the noise) and the nats it loses.
    """

    effect: Effect
    in_library: bool
    ratio_db: float
    joint_db: float
    nats: float
    rivals: dict[str, dict[str, float]]

    @property
    def unexplained_db(self) -> float:
        """What the best single rival leaves over the noise [dB]."""
        return min([self.ratio_db, *(rival["residual_db"] for rival in self.rivals.values())])

    @property
    def degenerate_with(self) -> list[str]:
        """Rivals that an ideal observer could not tell from the effect, though he sees it."""
        if self.nats < 2.0 * _INDISTINGUISHABLE_NATS:
            return []
        return [name for name, rival in self.rivals.items() if rival["nats"] < _INDISTINGUISHABLE_NATS]

    @property
    def mimicked_by(self) -> list[str]:
        """Rivals that leave less than the noise, and 10 dB less than the effect."""
        low = min(0.0, self.ratio_db - 10.0)
        return [name for name, rival in self.rivals.items() if rival["residual_db"] < low]


def draw_campaign(
    rng: np.random.Generator, kind: Kind, *, records: RecordFolder | None = None, with_rivals: bool = True,
    noise_kind: str | None = None, snr_db: float | None = None, effect: str | None = None,
    observation: Observation | None = None,
) -> tuple[Laboratory, list[Hidden]]:  # fmt: skip
    """Return a laboratory with its hidden effects in place, and how clearly each shows.

    The effects are drawn first and kept; laboratories are drawn until one can show them.
    """
    definitions = [registry()[effect]] if effect is not None else draw_definitions(rng, kind)
    for _ in range(_ATTEMPTS):
        wishes = _draw_wishes(rng, kind, definitions, records)
        wishes = replace(
            wishes, noise_kind=noise_kind, snr_db=snr_db, observation=observation or wishes.observation
        )
        laboratory = draw_laboratory(rng, wishes)
        placed = _place(rng, laboratory, kind, definitions)
        if placed is None:
            continue
        hidden = judge(placed, laboratory, with_rivals=with_rivals or kind is Kind.OUTSIDE)
        if acceptable(kind, hidden):
            return replace(laboratory, case=placed), hidden
    names = ", ".join(definition.name for definition in definitions)
    raise RuntimeError(f"no laboratory of {_ATTEMPTS} could show {names} as {kind}; draw another seed")


def _draw_wishes(
    rng: np.random.Generator, kind: Kind, definitions: list[Definition], records: RecordFolder | None
) -> Wishes:
    allowed = list(Observation)
    for definition in definitions:
        seen = one_channel_observations(definition) if kind is Kind.ONE_CHANNEL else observations(definition)
        allowed = [one for one in allowed if one in seen]
    weights = np.array([2.0 if one is Observation.FULL else 1.0 for one in allowed])
    return Wishes(
        observation=allowed[rng.choice(len(allowed), p=weights / weights.sum())],
        miscalibrated=kind is not Kind.NONE,
        massless_specimen=any(d.name in INERTIAL_ENEMIES for d in definitions),
        records=records,
    )


def _target(rng: np.random.Generator, kind: Kind, snr_db: float) -> float:
    """Return the effect-to-noise ratio to aim at [dB]: never more than half of the signal."""
    if kind is Kind.FAINT:
        return float(rng.uniform(-25.0, -1.5))
    low = 7.5 if kind is Kind.ONE_CHANNEL else 1.5
    high = 22.0 if kind in {Kind.DOUBLE, Kind.TRIPLE} else 26.0
    return float(rng.uniform(low, max(min(high, snr_db - 6.0), low + 2.0)))


def _place(
    rng: np.random.Generator, laboratory: Laboratory, kind: Kind, definitions: list[Definition]
) -> Case | None:
    """Return the campaign with all effects at their wished sizes, None where the loop cannot bear them."""
    case = laboratory.case
    limit = largest_command(laboratory)
    targets = [_target(rng, kind, laboratory.snr_db) for _ in definitions]
    sizings = []
    for definition, target in zip(definitions, targets, strict=True):
        sizing = Sizing(
            case=_judged_tests(case), definition=definition, scales=laboratory.scales,
            shape=rng.uniform(size=6), largest_command=limit,
        )  # fmt: skip
        effect = sized_effect(sizing, target_db=target, snr_db=laboratory.snr_db)
        if effect is None:
            return None
        sizings.append(sizing)
        case = case.having(case.rig.adding(effect))
    return _balanced(laboratory, case, sizings, targets) if len(definitions) > 1 else case


def _judged_tests(case: Case) -> Case:
    """Return the training tests, only the two strongest where every look costs refits of the loop."""
    training = case.training
    if training.observation not in ONE_CHANNEL:
        return training
    peaks = [float(np.abs(given).max()) for given in training.inputs]
    return training.subset(sorted(np.argsort(peaks)[-2:]))


def _balanced(laboratory: Laboratory, case: Case, sizings: list[Sizing], targets: list[float]) -> Case | None:
    """Return the campaign after effects that drowned behind the others were enlarged, at most twice."""
    limit = largest_command(laboratory)
    for _ in range(3):
        training = case.training
        responses = training.run(_COARSE_HZ)
        if not believable(responses, limit):
            return None
        lacks = [
            min(ratio, joint) for ratio, joint in (_ratios(training, e, responses) for e in case.rig.effects)
        ]
        if min(lacks) >= 0.3:
            return case
        place = int(np.argmin(lacks))
        targets = [t + 1.5 - lacks[i] if i == place else t for i, t in enumerate(targets)]
        old = case.rig.effects[place]
        others = case.having(case.rig.without(old))
        sizing = replace(sizings[place], case=others.training)
        new = sized_effect(sizing, target_db=targets[place], snr_db=laboratory.snr_db)
        if new is None:
            return None
        effects = tuple(new if effect is old else effect for effect in case.rig.effects)
        case = case.having(replace(case.rig, effects=effects))
    return None


def largest_command(laboratory: Laboratory) -> float:
    """Return the displacement [m] beyond which a test no longer resembles the one that was planned."""
    return 4.0 * laboratory.scales.displacement_peak


def _ratios(case: Case, effect: Effect, responses: list[Response]) -> tuple[float, float]:
    """Return an effect's ratio [dB] after calibration, and with the channel's other effects free as well."""
    change = effect_change(case, effect, responses)
    alone = effect_to_noise(case, change, calibrated_residual(change))
    others = [other for other in case.rig.effects if other is not effect]
    columns = _contributions(case, others, change, responses)
    return alone, effect_to_noise(case, change, calibrated_residual(change, columns)) if columns else alone


def _contributions(
    case: Case, others: list[Effect], change: Change, responses: list[Response]
) -> list[list[Array]] | None:
    """Return what the other effects do to the same channel, one column each, per test."""
    found = []
    for other in others:
        theirs = effect_change(case, other, responses)
        if theirs.channel == change.channel:
            theirs = theirs.coarse()
            found.append([a - b for a, b in zip(theirs.with_effect, theirs.without, strict=True)])
    return [list(columns) for columns in zip(*found, strict=True)] if found else None


def judge(case: Case, laboratory: Laboratory, *, with_rivals: bool) -> list[Hidden]:
    """Return how clearly each hidden effect of a campaign shows in its training tests."""
    training = case.training
    responses = training.run(_COARSE_HZ)
    if not believable(responses, largest_command(laboratory)):
        return []
    return [_judged(training, effect, responses, laboratory, with_rivals) for effect in case.rig.effects]


def _judged(
    case: Case, effect: Effect, responses: list[Response], laboratory: Laboratory, with_rivals: bool  # noqa: FBT001
) -> Hidden:  # fmt: skip
    if case.observation in ONE_CHANNEL:
        channel, rate = "measured_m", loop_rate(case)
        left = loop_residual(case, effect, evaluations=30)
        ratio = joint = decibels(root_mean_square(left) / case.noise_rms[channel])
        strongest = _judged_tests(case)
        plain, residuals = (
            loop_rival_residuals(strongest, effect, laboratory.scales) if with_rivals else ([], {})
        )
    else:
        change = effect_change(case, effect, responses)
        channel, rate = change.channel, change.coarse().rate_hz
        left = calibrated_residual(change)
        ratio, joint = _ratios(case, effect, responses)
        plain, residuals = (
            rival_residuals(case, effect, change, responses, laboratory.scales) if with_rivals else ([], {})
        )
    rivals = {
        name: {
            "residual_db": round(ratio + decibels(root_mean_square(rest) / root_mean_square(plain)), 2),
            "nats": round(nats(case, channel, rest, rate), 1),
        }
        for name, rest in residuals.items()
    }
    return Hidden(
        effect=effect, in_library=registry()[effect.name].in_library, ratio_db=ratio, joint_db=joint,
        nats=nats(case, channel, left, rate), rivals=rivals,
    )  # fmt: skip


def acceptable(kind: Kind, hidden: list[Hidden]) -> bool:
    """Return whether a campaign is what its kind promises."""
    if kind in {Kind.NONE, Kind.MISCALIBRATED}:
        return True
    if not hidden:
        return False
    if kind is Kind.FAINT:
        return all(one.ratio_db < 0.0 for one in hidden)
    if kind is Kind.ONE_CHANNEL:
        return all(one.ratio_db >= 6.0 for one in hidden)
    if kind is Kind.OUTSIDE:
        return all(one.unexplained_db >= 0.0 for one in hidden)
    return all(min(one.ratio_db, one.joint_db) >= 0.0 for one in hidden)
