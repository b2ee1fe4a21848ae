"""Probabilistic reliability of real-time hybrid simulation.

Commands that answer have functions here: `load_motions`, `simulate`, `ellipses`, `derive_criterion`,
`assess`, `design_test`, `cross_validate`, `diagnose`, `run_study` and `write_report`; beside them stand what
reads their input (`open_results`, `read_ellipses`, `read_recording`, `read_campaign`), `published_criterion`,
a `Structure` and the `InputError` that bad input raises. Each is imported when it is first asked for.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
