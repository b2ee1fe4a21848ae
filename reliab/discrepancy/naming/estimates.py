"""Values of fitted parameters with their standard deviations."""

from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.result.missing_effect import Estimate
from reliab.effects import Effect

_NOTHING = 1e-8  # SI value of a parameter whose lower bound stands a hair below zero


def estimates(effect: type[Effect], fitted: Fit) -> tuple[Estimate, ...]:
    """Parameters of an effect with their standard deviations, SI units."""
    place = fitted.space.places(effect)
    values = fitted.space.values(fitted.coordinates)[place]
    spread = fitted.space.standard_deviations(fitted.coordinates, fitted.covariance)[place]
    return tuple(
        Estimate(
            name=parameter.name, value=value if abs(value) > _NOTHING else 0.0, sd=sd, units=parameter.units
        )
        for parameter, value, sd in zip(effect.parameters, values.tolist(), spread.tolist(), strict=True)
    )


def calibration(fitted: Fit) -> tuple[Estimate, ...]:
    """Calibrated values with their standard deviations."""
    values = fitted.space.values(fitted.coordinates)
    spread = fitted.space.standard_deviations(fitted.coordinates, fitted.covariance)
    return tuple(
        Estimate(name=c.parameter.name, value=float(values[k]), sd=float(spread[k]), units=c.parameter.units)
        for k, c in enumerate(fitted.space.block.calibrations)
    )
