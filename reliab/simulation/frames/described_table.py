"""The base of the tables of `frame.toml`: known keys only, finite numbers only."""

from pydantic import BaseModel, ConfigDict


class DescribedTable(BaseModel):
    """A table that holds its own keys and no others."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
