"""`reliab info`: the facts about an installation that a bug report needs."""

from dataclasses import dataclass

from reliab.cli.demand import Demand, takes
from reliab.cli.options import JSON_TARGET
from reliab.cli.output import write_json, write_line


@dataclass(frozen=True, kw_only=True)
class InfoDemand(Demand):
    """Options of `reliab info`."""

    json_target: str | None = JSON_TARGET


@takes(InfoDemand)
def info(demand: InfoDemand) -> None:
    """Print versions, shipped data and where compiled code is kept, for a bug report."""
    from reliab.api import describe_installation

    content = demand.ask(describe_installation, "json_target")
    if write_json(content, demand.json_target):
        return
    for name, value in content.items():
        if isinstance(value, dict):
            write_line(f"{name}:")
            for key, text in value.items():
                write_line(f"  {key}: {text}")
        else:
            write_line(f"{name}: {value}")
