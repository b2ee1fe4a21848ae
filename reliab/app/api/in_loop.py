"""`reliab.export_monitor`: the running error of a structure as C or as an FMU, for the loop of a test."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from reliab.app.api.arguments import Quantity, require_sound, stated_values
from reliab.app.api.following import model_of, refuse_beside
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.files import refuse_unwritable, written_whole
from reliab.core.physical_range import require_physical
from reliab.core.vocabulary import Metric
from reliab.in_loop.fmu import pack_fmu
from reliab.in_loop.sources import LoopMonitor, monitor_sources
from reliab.simulation.frames.frame_file import FrameUnderTest, read_structure
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

_MILLISECONDS = 1e-3
_FMUS = {"fmu": 2, "fmu3": 3}
"""Version of FMI by the kind that is asked for."""
_LONGEST_LAG = 1000.0  # ms


@dataclass(frozen=True, kw_only=True)
class WrittenMonitor:
    """A monitor that was written."""

    path: Path
    files: tuple[str, ...]
    degrees_of_freedom: int

    def to_dict(self) -> dict[str, Any]:
        """Plain values with stable keys."""
        return {
            "path": str(self.path),
            "files": list(self.files),
            "degrees_of_freedom": self.degrees_of_freedom,
        }


def export_monitor(
    export: tuple[str, str | Path],
    *,
    f: Quantity | None = None,
    xi: Quantity | None = None,
    alpha: Quantity = 1.0,
    structure: str | Path | None = None,
    model: str | Path | UpdatedModel | None = None,
    scale: Quantity | None = None,
    feedback_lag: Quantity = 0.0,
    threshold: float = 0.05,
    metric: str = "rms",
    rate: float | None = None,
) -> WrittenMonitor:
    """Write the running error for the loop of a test, as C or as an FMU.

    Parameters
    ----------
    export : tuple of str and path
        "c" and a folder, or "fmu" (FMI 2.0) or "fmu3" (FMI 3.0) and a file.
    f, xi, alpha : float, str or StatedValue
        Natural frequency [Hz], damping ratio [-] and share of the stiffness in the laboratory [-]; standard
        deviations are not used.
    structure : str or pathlib.Path, optional
        TOML file of a frame with a linear specimen, driven by one actuator or several, in place of `f`, `xi`
        and `alpha`.
    model : str, pathlib.Path or UpdatedModel, optional
        Model of the test, in place of `f`, `xi` and `alpha`, whose specimen may be nonlinear; effects whose
        step cannot be written in C are refused by name.
    scale, feedback_lag : float, str or StatedValue, optional
        Scale of the displacement sensor [-], 1 by default; time by which the force is fed back late [ms].
    threshold : float, optional
        Largest error of a good test [-]; the alarm of the error is raised above twice of it.
    metric : {"rms", "mte"}, optional
        Error that is compared.
    rate : float
        Rate of the loop [Hz].

    Returns
    -------
    WrittenMonitor
        Where it was written.

    Raises
    ------
    InputError
        If something is not stated or not allowed, or nothing can be written there.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     export_monitor(("c", folder), f=1, xi=0.02, rate=1024).degrees_of_freedom
    1
    """
    kind, place = export[0], Path(export[1])
    if kind != "c" and kind not in _FMUS:
        raise InputError(
            "`export` writes c, fmu or fmu3",
            value=kind,
            remedy="Name one of them, and the folder or file to write",
        )
    exactly = 1.0 if scale is None else scale
    read = partial(
        _structure, f=f, xi=xi, alpha=alpha, feedback_lag=feedback_lag, frame=structure, model=model
    )
    monitor = _monitor(read, exactly, feedback_lag, threshold, metric, rate)
    if kind in _FMUS:
        content = {place: pack_fmu(monitor, _FMUS[kind])}
    else:
        content = {place / name: text.encode() for name, text in monitor_sources(monitor).items()}
    _write(content)
    names = tuple(sorted(path.name for path in content))
    return WrittenMonitor(path=place, files=names, degrees_of_freedom=monitor.degrees_of_freedom)


def _monitor(
    read: Callable[[], tuple[Partition | HybridTest, Array | None]],
    scale: Quantity,
    feedback_lag: Quantity,
    threshold: float,
    metric: str,
    rate: float | None,
) -> LoopMonitor:
    """Read what the monitor is made for."""
    if rate is None:
        raise InputError("A monitor in a loop needs `rate`, the rate of the loop", remedy="Give it in hertz")
    require_physical("error threshold", threshold, called="value of `threshold`")
    require_physical("sampling rate", rate, called="value of `rate`")
    stated = stated_values(scale=scale, feedback_lag=feedback_lag)
    require_sound(stated)
    lag = stated["feedback_lag"].value
    if not 0.0 <= lag <= _LONGEST_LAG:
        raise InputError(f"`feedback_lag` must be 0 to {_LONGEST_LAG:g} ms", value=f"{lag:g} ms")
    tested, to_interface = read()
    return LoopMonitor(
        structure=tested,
        to_interface=to_interface,
        time_step=1.0 / rate,
        feedback_lag=lag * _MILLISECONDS,
        sensor_scale=stated["scale"].value,
        threshold=threshold,
        metric=Metric.parse(metric),
    )


def _structure(
    *,
    f: Quantity | None,
    xi: Quantity | None,
    alpha: Quantity,
    feedback_lag: Quantity,
    frame: str | Path | None,
    model: str | Path | UpdatedModel | None,
) -> tuple[Partition | HybridTest, Array | None]:
    """Return the structure, and interface displacements per unit of each channel of several."""
    if frame is not None and model is not None:
        raise InputError(
            "A monitor in a loop needs either a `structure` or a `model`", remedy="Leave one out"
        )
    if frame is not None:
        refuse_beside("structure", f=f, xi=xi, alpha=alpha)
        return _of_frame(read_structure(frame), str(frame))
    if model is not None:
        return model_of(model, f=f, xi=xi, alpha=alpha, feedback_lag=feedback_lag).test, None
    for name, value in {"f": f, "xi": xi}.items():
        if value is None:
            raise InputError(
                f"A monitor in a loop needs `{name}`, or the `structure` of a frame, or a `model`",
                remedy="State one of them",
            )
    stated = stated_values(f=f, xi=xi, alpha=alpha)
    require_sound(stated)
    structure = Structure(
        frequency=stated["f"].value,
        damping_ratio=stated["xi"].value,
        experimental_fraction=stated["alpha"].value,
    )
    return Partition.of_structure(structure), None


def _of_frame(frame: FrameUnderTest, where: str) -> tuple[Partition, Array | None]:
    """Return the structure of a frame with a linear specimen."""
    if frame.several:
        if frame.geometry is not None and not frame.channels_at_interface:
            raise InputError(
                "A monitor in a loop carries actuators to the interface by a matrix",
                value="[kinematics.geometry]",
                remedy=f"Give matrix = {frame.kinematics.round(6).tolist()} if rotations are small, or take "
                'channels at the "interface"',
                where=where,
            )
        return frame.partition, frame.to_interface
    if frame.output is not None:
        raise InputError(
            "A monitor in a loop computes the error of the measured interface displacement",
            value=frame.error_of,
            remedy='Leave [error] out, or give of = "interface"',
            where=where,
        )
    if frame.partition.effects:
        raise InputError(
            "A monitor in a loop of a frame is made for a linear specimen",
            value=", ".join(effect.name for effect in frame.partition.effects),
            remedy="Leave [[specimen.effects]] out if the specimen is nearly linear",
            where=where,
        )
    return frame.partition, None


def _write(content: dict[Path, bytes]) -> None:
    for path, data in content.items():
        with refuse_unwritable("The folder or file of a monitor must be writable", where=path):
            path.parent.mkdir(parents=True, exist_ok=True)
            with written_whole(path) as unfinished:
                unfinished.write_bytes(data)
