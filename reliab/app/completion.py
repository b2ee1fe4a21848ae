"""Names that the shell completes: what ships, and what is registered.

Each function takes the beginning of a word; what it needs is imported when the shell asks. Where a file may
stand as well, an empty word is left to the shell, which offers files.
"""

from collections.abc import Iterable

_SAMPLES = ("sample_test",)
_CAMPAIGNS = ("rig_a", "rig_b", "rig_c")
_SUITES = ("synthetic",)
_RESULTS = ("real_suite",)


def studies(incomplete: str) -> list[str]:
    """Complete the name of a study that ships."""
    from reliab.core.shipped import shipped

    return _begun(
        incomplete, sorted(file.parent.name for file in shipped("studies", "").glob("*/study.toml"))
    )


def samples(incomplete: str) -> list[str]:
    """Complete the name of a test that ships."""
    return _begun(incomplete, _SAMPLES) if incomplete else []


def campaigns(incomplete: str) -> list[str]:
    """Complete the name of a campaign that ships."""
    return _begun(incomplete, _CAMPAIGNS) if incomplete else []


def suites(incomplete: str) -> list[str]:
    """Complete the name of a suite of ground motions that is built in."""
    return _begun(incomplete, _SUITES) if incomplete else []


def results(incomplete: str) -> list[str]:
    """Complete the name of results and ellipses that ship."""
    return _begun(incomplete, _RESULTS) if incomplete else []


def methods(incomplete: str) -> list[str]:
    """Complete the name of a meaning of confidence."""
    from reliab.criterion.methods.registry import METHODS

    return _begun(incomplete, METHODS)


def laws(incomplete: str) -> list[str]:
    """Complete the name of a law of natural frequency and damping ratio."""
    from reliab.criterion.laws.registry import FITTED, OF_MANY_MOTIONS

    return _begun(incomplete, [*FITTED, *OF_MANY_MOTIONS])


def metrics(incomplete: str) -> list[str]:
    """Complete the name of an error."""
    return _begun(incomplete, ("rms", "mte"))


def papers(incomplete: str) -> list[str]:
    """Complete the name of a paper."""
    return _begun(incomplete, ("a4", "letter"))


def _begun(incomplete: str, names: Iterable[str]) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]
