"""With what results were computed: every package, Python, the system and the processor."""

import platform
import re
from functools import cache
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path

_NAME = re.compile(r"[A-Za-z0-9._-]+")
_PROCESSORS = Path("/proc/cpuinfo")


def environment() -> dict[str, object]:
    """Describe what results are computed with.

    Equal input gives equal bytes where all of this is equal; with another processor or other packages the
    last digits of numbers may differ.

    Returns "python", "system", "processor" and "packages": versions of this package and of all that it needs,
    directly or through others.
    """
    return {
        "python": platform.python_version(),
        "system": platform.platform(),
        "processor": _processor(),
        "packages": dict(_packages()),
    }


@cache
def _packages() -> tuple[tuple[str, str], ...]:
    waiting, versions = ["reliab"], {}
    while waiting:
        name = waiting.pop()
        if name in versions:
            continue
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            continue  # needed on other systems only
        needed = [line for line in requires(name) or () if "extra ==" not in line]
        names = [match[0].lower() for line in needed if (match := _NAME.match(line))]
        waiting.extend(re.sub(r"[-_.]+", "-", package) for package in names)  # a package has one name
    return tuple(sorted(versions.items()))


@cache
def _processor() -> str:
    """Name of the processor, as the system states it."""
    try:
        text = _PROCESSORS.read_text(encoding="utf-8", errors="replace")
    except OSError:
        text = ""
    match = re.search(r"^model name\s*:\s*(.+)$", text, re.MULTILINE)
    return match[1].strip() if match else platform.processor() or platform.machine()
