"""From a diagnosis to the updated model: what every block calibrated and named, put together."""

from dataclasses import replace

from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis
from reliab.discrepancy.result.diagnosis import Diagnosis
from reliab.effects import ExcitationScale, library
from reliab.simulation.hybrid_test import HybridTest, UpdatedModel

_WITHOUT_FRAME = (
    "This file holds the actuator, the specimen and the effects; the frame of these tests stands in their"
    " campaign.toml, and without it no closed loop can be computed."
)


def updated_model(diagnosis: Diagnosis) -> UpdatedModel:
    """Put together the model that a diagnosis arrives at.

    Calibrated values and effects are those of the best model of the block that saw them. Effects of the
    library are added when they are named, or when something of their kind acts and they explain it best;
    a term outside the library is not, because nothing else could simulate it. The nominal structure is kept
    but for values with which the tests clearly did not run (`BlockDiagnosis.misstated`).
    """
    test = diagnosis.campaign.nominal
    deviations: dict[str, float] = {}
    for diagnosed in diagnosis.blocks:
        test = _joined(test, diagnosed)
        deviations.update(_deviations(diagnosed))
    limits = diagnosis.remarks
    if diagnosis.campaign.partition is not None:
        limits = (*limits, _WITHOUT_FRAME)
    return UpdatedModel(name=diagnosis.campaign.name, test=test, deviations=deviations, limits=limits)


def _joined(test: HybridTest, diagnosed: BlockDiagnosis) -> HybridTest:
    """Take over from a block what it calibrated and what it names."""
    names = {calibration.parameter.name for calibration in diagnosed.block.calibrations}
    model = diagnosed.best.space.model(diagnosed.best.coordinates)
    believed = {missing.effect for missing in (*diagnosed.effects, *diagnosed.doubtful)} & set(
        library().values()
    )
    test = test.adding(*(effect for effect in model.effects if type(effect) in believed))
    if "gain" in names or "delay_s" in names:
        test = replace(test, actuator=model.actuator)
    if any(name.startswith("stiffness") for name in names):
        test = replace(test, specimen=model.specimen)
    misstated = {item.name: item.value for item in diagnosed.misstated}
    for calibration in diagnosed.block.calibrations:
        if calibration.parameter.name in misstated:
            test = calibration.apply(test, misstated[calibration.parameter.name])
    if "damping" in names:
        test = replace(test, structure=model.structure)
    if "excitation_scale" in names:
        test = test.adding(*(effect for effect in model.effects if isinstance(effect, ExcitationScale)))
    return test


def _deviations(diagnosed: BlockDiagnosis) -> dict[str, float]:
    """Return standard deviations in SI units of what a block calibrated and named."""
    fitted = diagnosed.best
    spread = fitted.space.standard_deviations(fitted.coordinates, fitted.covariance).tolist()
    sizes = _sizes(fitted)
    calibrated = {
        sizes[calibration.parameter.name][0]: sizes[calibration.parameter.name][1] * sd
        for calibration, sd in zip(diagnosed.block.calibrations, spread, strict=False)
        if calibration.parameter.name in sizes
    }
    named = {
        f"{effect.effect.name}.{estimate.name}": estimate.sd
        for effect in (*diagnosed.effects, *diagnosed.doubtful)
        for estimate in effect.estimates
    }
    return {**calibrated, **named}


def _sizes(fitted: Fit) -> dict[str, tuple[str, float]]:
    """Name in the model's file and unit in SI of every calibration by its name."""
    nominal = fitted.space.block.nominal
    stiffness = 0.0 if nominal.specimen is None else nominal.specimen.stiffness
    return {
        "gain": ("gain", nominal.actuator.gain),
        "delay_s": ("delay_s", 1.0),
        "stiffness": ("stiffness_n_per_m", stiffness),
        "stiffness_n_per_m": ("stiffness_n_per_m", 1.0),
        "excitation_scale": ("excitation_scale.scale", _expected_scale(fitted)),
    }


def _expected_scale(fitted: Fit) -> float:
    """Scale of the ground motion at which the calibrated factor on it is one."""
    calibrations = fitted.space.block.calibrations
    nominal = fitted.space.block.nominal
    return next(
        (1.0 / c.nominal(nominal) for c in calibrations if c.parameter.name == "excitation_scale"), 1.0
    )
