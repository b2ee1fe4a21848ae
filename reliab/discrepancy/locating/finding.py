"""A place where a model fails."""

from dataclasses import dataclass
from typing import Any

from reliab.renamed import renamed_method


@renamed_method("0.4", "as_dict", "to_dict")
@dataclass(frozen=True, kw_only=True)
class Finding:
    """A place where the calibrated model fails."""

    block: str  # block, channel: Where in the loop, and in which column
    channel: str
    test: str  # File of the test in which it shows most
    kind: str  # What the residual depends on
    detail: str  # One sentence
    share_of_residual: float  # Part of the residual's power above the noise that it accounts for, in [0, 1]
    p_value: float  # Probability of as much under noise alone, corrected for the number of tests made

    def to_dict(self) -> dict[str, Any]:
        """Return the entry of `where`."""
        return {
            "block": self.block,
            "channel": self.channel,
            "test": self.test,
            "kind": self.kind,
            "detail": self.detail,
            "share_of_residual": self.share_of_residual,
            "p_value": self.p_value,
        }
