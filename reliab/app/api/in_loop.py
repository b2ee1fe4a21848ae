"""`reliab.export_monitor`: the running error of a structure as C or as an FMU, for the loop of a test."""

from dataclasses import dataclass
from pathlib import Path
from typing import Unpack

from reliab.app import questions
from reliab.app.api.arguments import (
    STRUCTURE,
    parse_threshold,
    refuse_stated,
    require_sound,
    stated_quantities,
    structure_of,
)
from reliab.app.api.following import read_followed_model
from reliab.app.declaration import asks
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.files import refuse_unwritable, written_whole
from reliab.core.physical_range import require_physical
from reliab.core.plain_values import PlainResult
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Metric
from reliab.in_loop.fmu import pack_fmu
from reliab.in_loop.sources import LoopMonitor, monitor_sources
from reliab.simulation.frames.frame_file import FrameUnderTest, read_structure
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.structures.partition import Partition

_MILLISECONDS = 1e-3
_FMUS = {"fmu": 2, "fmu3": 3}
"""Version of FMI by the kind that is asked for."""
_LONGEST_LAG = 1000.0  # ms


@dataclass(frozen=True, kw_only=True)
class WrittenMonitor(PlainResult):
    """A monitor that was written."""

    path: Path
    files: tuple[str, ...]
    degrees_of_freedom: int


@asks(questions.LoopMonitorQuestion)
def export_monitor(
    export: tuple[str, str | Path], **request: Unpack[questions.LoopMonitorQuestion]
) -> WrittenMonitor:
    """Write the running error for the loop of a test, as C or as an FMU.

    Standard deviations are not used. The alarm of the error is raised above twice the threshold. A frame must
    have a linear specimen; effects of a model whose step cannot be written in C are refused by name.

    Parameters
    ----------
    export : tuple of str and path
        "c" and a folder, or "fmu" (FMI 2.0) or "fmu3" (FMI 3.0) and a file.

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
            "Unknown kind of `export`",
            value=kind,
            remedy="Name c, fmu or fmu3, and the folder or file to write",
        )
    monitor = _monitor(request)
    if kind in _FMUS:
        content = {place: pack_fmu(monitor, _FMUS[kind])}
    else:
        content = {place / name: text.encode() for name, text in monitor_sources(monitor).items()}
    _write(content)
    names = tuple(sorted(path.name for path in content))
    return WrittenMonitor(path=place, files=names, degrees_of_freedom=monitor.degrees_of_freedom)


def _monitor(request: questions.LoopMonitorQuestion) -> LoopMonitor:
    """Read what the monitor is made for."""
    rate = request["rate"]
    if rate is None:
        raise InputError("The monitor needs `rate`, the rate of the loop", remedy="Give it in hertz")
    threshold = parse_threshold(request["threshold"])
    require_physical("sampling rate", rate, label="value of `rate`")
    values = {
        "scale": StatedValue(1.0),
        "feedback_lag": StatedValue(0.0),
        **stated_quantities({**request}),
    }
    require_sound(values)
    lag = values["feedback_lag"].value
    if not 0.0 <= lag <= _LONGEST_LAG:
        raise InputError(
            f"`feedback_lag` must be 0 to {_LONGEST_LAG:g} ms",
            value=f"{lag:g} ms",
            remedy="State it in milliseconds",
        )
    structure, interface_matrix = _structure(request)
    return LoopMonitor(
        structure=structure,
        to_interface=interface_matrix,
        time_step=1.0 / rate,
        feedback_lag=lag * _MILLISECONDS,
        sensor_scale=values["scale"].value,
        threshold=threshold,
        metric=Metric.parse(request["metric"] or Metric.RMS),
    )


def _structure(request: questions.LoopMonitorQuestion) -> tuple[Partition | HybridTest, Array | None]:
    """Return the structure, and interface displacements per unit of each channel of several."""
    frame, question = request["structure"], {**request}
    if frame is not None and request["model"] is not None:
        raise InputError(
            "A monitor in a loop needs either a `structure` or a `model`", remedy="Leave one out"
        )
    if frame is not None:
        reason = "together with `structure`, which describes the test"
        refuse_stated(question, *STRUCTURE, reason=reason, defaults={"alpha": 1.0})
        return _partition_of_frame(read_structure(frame), str(frame))
    if (model := read_followed_model(question)) is not None:
        return model.test, None
    for name in ("f", "xi"):
        if question[name] is None:
            raise InputError(
                f"A monitor in a loop needs `{name}`, or the `structure` of a frame, or a `model`",
                remedy="State one of them",
            )
    return Partition.from_structure(structure_of(stated_quantities(question))), None


def _partition_of_frame(frame: FrameUnderTest, source: str) -> tuple[Partition, Array | None]:
    """Return the structure of a frame with a linear specimen."""
    if frame.has_several:
        if frame.geometry is not None and not frame.channels_at_interface:
            raise InputError(
                "A monitor in a loop needs the kinematics of the actuators as a matrix",
                value="[kinematics.geometry]",
                remedy=f"Give matrix = {frame.kinematics.round(6).tolist()} if rotations are small, or take "
                'channels at the "interface"',
                where=source,
            )
        return frame.partition, frame.to_interface
    if frame.output is not None:
        raise InputError(
            "A monitor in a loop computes the error of the measured interface displacement",
            value=frame.error_of,
            remedy='Leave [error] out, or give of = "interface"',
            where=source,
        )
    if frame.partition.effects:
        raise InputError(
            "A monitor in a loop of a frame is made for a linear specimen",
            value=", ".join(effect.name for effect in frame.partition.effects),
            remedy="Leave [[specimen.effects]] out if the specimen is nearly linear",
            where=source,
        )
    return frame.partition, None


def _write(content: dict[Path, bytes]) -> None:
    for path, data in content.items():
        with refuse_unwritable("Cannot write the folder or file of a monitor", where=path):
            path.parent.mkdir(parents=True, exist_ok=True)
            with written_whole(path) as temporary:
                temporary.write_bytes(data)
