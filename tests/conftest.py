"""Fixtures shared by all rooms."""

from pathlib import Path

import pytest

_SHARED = Path(__file__).resolve().parents[2] / "shared"


@pytest.fixture(scope="session")
def shared_folder() -> Path:
    """The folder beside the checkout with real records, skipped where it is absent."""
    if not _SHARED.is_dir():
        pytest.skip(f"the real records are not here ({_SHARED})")
    return _SHARED


@pytest.fixture(scope="session")
def real_motions_folder(shared_folder: Path) -> Path:
    """The folder of real ground-motion records."""
    return shared_folder / "motions"
