"""Effects that a campaign cannot distinguish, and the further test that would."""

_TELLS = {
    frozenset({"first_order_lag", "second_order_dynamics"}):
        "A sweep to twice the servo's bandwidth shows whether the amplitude peaks or only falls",
    frozenset({"first_order_lag", "delay_drift"}):
        "A steady sine, or a sweep run downwards, separates time from frequency",
    frozenset({"second_order_dynamics", "delay_drift"}):
        "A steady sine, or a sweep run downwards, separates time from frequency",
    frozenset({"sensor_bias", "force_bias"}):
        "Record both channels with the specimen disconnected",
    frozenset({"coulomb_friction", "hysteresis"}):
        "Slow cycles of growing amplitude show whether the force jumps or bends at each reversal",
    frozenset({"coulomb_friction", "viscous_damping"}):
        "Cycles of one amplitude at two speeds show whether the dissipated energy depends on the speed",
    frozenset({"viscous_damping", "quadratic_damping"}):
        "Cycles at two speeds show whether the damping force grows with the speed or with its square",
    frozenset({"gap", "backlash"}):
        "Record command and force as well: slack in the actuator shows between command and displacement",
    frozenset({"added_mass", "cubic_stiffness"}):
        "Slow cycles of the same amplitude leave the inertia out",
}  # fmt: skip

_OTHERWISE = "A test with a stronger input of wider band, recorded on all four channels, would decide it"


def telling_test(effect: str, rival: str) -> str:
    """Return the test that would distinguish two effects, as a sentence without its final full stop."""
    pair = {str(effect), str(rival)}
    return next((text for names, text in _TELLS.items() if {str(n) for n in names} == pair), _OTHERWISE)


def remark(name: str, probability: float, rival: tuple[str, float] | None) -> str:
    """State from which other effect an effect cannot be distinguished."""
    words = name.replace("_", " ")
    if rival is None:
        return f"The data hint at {words} without settling it. {_OTHERWISE}."
    rival_name = rival[0].replace("_", " ")
    return (
        f"The data do not tell {words} ({probability:.0%}) from {rival_name} ({rival[1]:.0%}). "
        f"{telling_test(name, rival[0])}."
    )
