"""The monitor as an FMU (FMI 2.0 or 3.0, co-simulation) whose sources a target compiles itself."""

import io
import uuid
import zipfile
from importlib.resources import files
from typing import Final

from reliab.in_loop.fmu_variables import describe_for_2, describe_for_3, list_variables
from reliab.in_loop.sources import CONFIGURATION, LoopMonitor, monitor_sources

_BEFORE_BUILDS: Final = 2
"""The version of FMI that names sources in the model's description, not in one of their own."""

_WHEN = (1980, 1, 1, 0, 0, 0)  # so that the bytes depend on the content only
_SPACE = uuid.UUID("4f3d8a52-6f0e-5a53-9d52-9c4b7be1a040")
_SOURCES = ("reliab_monitor.c", "reliab_monitor.h", CONFIGURATION)


def pack_fmu(monitor: LoopMonitor, version: int) -> bytes:
    """Return the file of an FMU of version 2 or 3; it is stepped at the time step of its monitor."""
    texts = monitor_sources(monitor)
    guid = str(uuid.uuid5(_SPACE, "".join(texts[name] for name in _SOURCES)))
    actuators = len(monitor.coefficients.carry)
    variables = list_variables(actuators)
    description = (
        describe_for_3(variables, actuators) if version > _BEFORE_BUILDS else describe_for_2(variables)
    )
    values = {"@GUID@": guid, "@STEP@": f"{monitor.time_step:.17g}", **description}
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for place, name in _templates(version).items():
            _write(archive, place, _filled(name, values))
        for name in _SOURCES:
            _write(archive, f"sources/{name}", texts[name])
        _write(archive, "documentation/README.md", texts["README.md"])
    return packed.getvalue()


def _templates(version: int) -> dict[str, str]:
    """Name the templates by their places in the FMU."""
    wrapper = f"fmi{version}.c"
    places = {
        "modelDescription.xml": f"modelDescription{version}.xml",
        f"sources/{wrapper}": wrapper,
        "sources/unit.h": "unit.h",
    }
    if version > _BEFORE_BUILDS:
        places["sources/buildDescription.xml"] = "buildDescription.xml"
    return places


def _filled(name: str, values: dict[str, str]) -> str:
    """Return a template with its values."""
    text = files("reliab.in_loop").joinpath("template", name).read_text(encoding="utf-8")
    for mark, value in values.items():
        text = text.replace(mark, value)
    return text


def _write(archive: zipfile.ZipFile, name: str, text: str) -> None:
    entry = zipfile.ZipInfo(name, _WHEN)
    entry.compress_type = zipfile.ZIP_DEFLATED
    archive.writestr(entry, text)
