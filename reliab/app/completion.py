"""Names that the shell completes: what ships, and what is registered.

Each function takes the beginning of a word; what it needs is imported when the shell asks. If a file may
stand in place of a name, an empty word is left to the shell, which offers files.
"""

from collections.abc import Callable, Iterable


def _any_of(*names: str, takes_files: bool = False) -> Callable[[str], list[str]]:
    """Complete one of some names; `takes_files`: whether a file may stand in their place."""
    return lambda incomplete: _complete_names(incomplete, names) if incomplete or not takes_files else []


samples = _any_of("sample_test", takes_files=True)
campaigns = _any_of("rig_a", "rig_b", "rig_c", takes_files=True)
suites = _any_of("synthetic", takes_files=True)
results = _any_of("real_suite", takes_files=True)
metrics = _any_of("rms", "mte")
papers = _any_of("a4", "letter")


def studies(incomplete: str) -> list[str]:
    """Complete the name of a study that ships."""
    from reliab.core.shipped import shipped

    return _complete_names(
        incomplete, sorted(file.parent.name for file in shipped("studies", "").glob("*/study.toml"))
    )


def methods(incomplete: str) -> list[str]:
    """Complete the name of a meaning of confidence."""
    from reliab.criterion.methods.registry import METHODS

    return _complete_names(incomplete, METHODS)


def laws(incomplete: str) -> list[str]:
    """Complete the name of a law of natural frequency and damping ratio."""
    from reliab.criterion.laws.registry import FITTED_LAWS, MANY_MOTION_LAWS

    return _complete_names(incomplete, [*FITTED_LAWS, *MANY_MOTION_LAWS])


def _complete_names(incomplete: str, names: Iterable[str]) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]
