"""What campaigns cannot tell apart, and the test that would."""

from reliab.vocabulary import EffectName

_TELLS = {
    frozenset({EffectName.FIRST_ORDER_LAG, EffectName.SECOND_ORDER_DYNAMICS}):
        "A sweep to twice the servo's bandwidth shows whether the amplitude peaks or only falls",
    frozenset({EffectName.FIRST_ORDER_LAG, EffectName.DELAY_DRIFT}):
        "A steady sine, or a sweep run downwards, separates time from frequency",
    frozenset({EffectName.SECOND_ORDER_DYNAMICS, EffectName.DELAY_DRIFT}):
        "A steady sine, or a sweep run downwards, separates time from frequency",
    frozenset({EffectName.SENSOR_BIAS, EffectName.FORCE_BIAS}):
        "Record both channels with the specimen disconnected",
    frozenset({EffectName.COULOMB_FRICTION, EffectName.HYSTERESIS}):
        "Slow cycles of growing amplitude show whether the force jumps or bends at each reversal",
    frozenset({EffectName.COULOMB_FRICTION, EffectName.VISCOUS_DAMPING}):
        "Cycles of one amplitude at two speeds show whether the dissipated energy depends on the speed",
    frozenset({EffectName.VISCOUS_DAMPING, EffectName.QUADRATIC_DAMPING}):
        "Cycles at two speeds show whether the damping force grows with the speed or with its square",
    frozenset({EffectName.GAP, EffectName.BACKLASH}):
        "Record command and force as well: slack in the actuator shows between command and displacement",
    frozenset({EffectName.ADDED_MASS, EffectName.CUBIC_STIFFNESS}):
        "Slow cycles of the same amplitude leave the inertia out",
}  # fmt: skip

_OTHERWISE = "A test with another input, stronger and with a wider band, on all four channels would tell"


def telling_test(effect: str, rival: str) -> str:
    """Return the test that would tell two effects apart, as a sentence without its final full stop."""
    pair = {str(effect), str(rival)}
    return next((text for names, text in _TELLS.items() if {str(n) for n in names} == pair), _OTHERWISE)


def remark(name: str, probability: float, rival: tuple[str, float] | None) -> str:
    """Say what an effect cannot be told from.

    Parameters
    ----------
    name : str
        An effect.
    probability : float
        Its probability.
    rival : tuple of (str, float) or None
        The most probable other effect in its place, with its probability.

    Returns
    -------
    str
        One or two sentences.
    """
    words = name.replace("_", " ")
    if rival is None:
        return f"The data hint at {words} without settling it. {_OTHERWISE}."
    rival_name = rival[0].replace("_", " ")
    return (
        f"The data do not tell {words} ({probability:.0%}) from {rival_name} ({rival[1]:.0%}). "
        f"{telling_test(name, rival[0])}."
    )
