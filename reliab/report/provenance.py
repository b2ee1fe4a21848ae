"""From what a report can be made again."""

from collections.abc import Mapping

from reliab.criterion.provenance import Provenance, installed_versions


def provenance_of(
    settings_by_name: Mapping[str, object], criterion: Provenance | None = None
) -> dict[str, str]:
    """Collect versions, checksums and settings.

    `settings_by_name`: what the caller knows, by its name: the hash of the study, seeds, …; shown first.
    """
    lines = {name: _line(value) for name, value in settings_by_name.items()}
    if criterion is None:
        return {"packages": _line(installed_versions()), **lines}
    settings = _line(criterion.settings)
    derived = {
        "source": criterion.source,
        "motions, earthquakes": f"{criterion.n_motions}, {criterion.n_events}",
        "records, SHA-256": criterion.records_checksum,
        "window": criterion.window,
        "settings of the method": settings,
        "packages": _line(criterion.packages),
    }
    return {**lines, **{name: text for name, text in derived.items() if text and name not in lines}}


def _line(value: object) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {_line(item)}" for name, item in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(_line(item) for item in value)
    return f"{value:g}" if isinstance(value, float) else str(value)
