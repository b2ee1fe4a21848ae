"""The monitor as an FMU (FMI 2.0, co-simulation) whose sources a target compiles itself."""

import io
import uuid
import zipfile
from importlib.resources import files

from reliab.in_loop.sources import CONFIGURATION, LoopMonitor, monitor_sources

_WHEN = (1980, 1, 1, 0, 0, 0)  # so that the bytes depend on the content only
_SPACE = uuid.UUID("4f3d8a52-6f0e-5a53-9d52-9c4b7be1a040")
_SOURCES = ("reliab_monitor.c", "reliab_monitor.h", CONFIGURATION)


def pack_fmu(monitor: LoopMonitor) -> bytes:
    """Return the file of an FMU; it is stepped at the time step of its monitor."""
    texts = monitor_sources(monitor)
    folder = files("reliab.in_loop").joinpath("template")
    wrapper, description = (
        folder.joinpath(name).read_text(encoding="utf-8") for name in ("fmi2.c", "modelDescription.xml")
    )
    guid = str(uuid.uuid5(_SPACE, "".join(texts[name] for name in _SOURCES)))
    content = {
        "modelDescription.xml": description.replace("@GUID@", guid).replace(
            "@STEP@", f"{monitor.time_step:.17g}"
        ),
        "sources/fmi2.c": wrapper.replace("@GUID@", guid),
        **{f"sources/{name}": texts[name] for name in _SOURCES},
        "documentation/README.md": texts["README.md"],
    }
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in content.items():
            entry = zipfile.ZipInfo(name, _WHEN)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, text)
    return packed.getvalue()
