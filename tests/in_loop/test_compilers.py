"""Each compiler that is installed accepts the sources strictly, and its sanitizers find nothing in them."""

import subprocess

import numpy as np
import pytest
from compiled_monitor import COMPILERS, FAULT, STRICT, build, build_monitor, compare, follow, needs_compiler
from drawn_tests import KINDS, draw_single_degree, random_test

from reliab.app.api.monitor import export_monitor
from reliab.in_loop.sources import monitor_sources

pytestmark = needs_compiler
BOTH = [
    pytest.param(
        name, marks=pytest.mark.skipif(name not in COMPILERS, reason=f"{name} is not installed here")
    )
    for name in ("gcc", "clang")
]
FIRST, *FURTHER = KINDS
SANITIZERS = ("address,undefined", "thread")
MATH_FUNCTIONS = {"sqrt", "log", "exp", "erfc", "ceil", "fabs", "pow", "tanh", "trunc"}
COMPILER_FUNCTIONS = {"memset", "memcpy", "__stack_chk_fail", "_GLOBAL_OFFSET_TABLE_"}
TWO_THREADS = """
#include "reliab_monitor.h"
#include <math.h>
#include <pthread.h>
static reliab_monitor monitors[2];
static void *follow(void *place)
{
    reliab_monitor *monitor = (reliab_monitor *)place;
    double command[RELIAB_ACTUATORS], measured[RELIAB_ACTUATORS];
    unsigned i, k;
    reliab_monitor_init(monitor);
    for (i = 0u; i < 5000u; i++) {
        for (k = 0u; k < RELIAB_ACTUATORS; k++) {
            command[k] = 0.01 * sin((6.0 + k) * RELIAB_STEP * i);
            measured[k] = 0.98 * command[k] + 1e-6 * sin(0.7 * i);
        }
        (void)reliab_monitor_step(monitor, command, measured);
    }
    return NULL;
}
int main(void)
{
    pthread_t threads[2];
    unsigned i, wrong = 0u;
    for (i = 0u; i < 2u; i++) { wrong |= (unsigned)pthread_create(&threads[i], NULL, follow, &monitors[i]); }
    for (i = 0u; i < 2u; i++) { wrong |= (unsigned)pthread_join(threads[i], NULL); }
    return wrong != 0u || monitors[0].samples != 5000u || monitors[0].status != monitors[1].status;
}
"""


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.parametrize("compiler", BOTH)
def test_fast_arithmetic_changes_nothing(tmp_path, compiler):
    _, command, reading = random_test(6, 512, 6.0)
    export_monitor(("c", tmp_path), f=1, xi=0.02, rate=512)
    exact = follow(build(tmp_path, compiler), command, reading)
    fast = follow(build(tmp_path, compiler, ("-std=c99", "-O3", "-ffast-math")), command, reading)
    assert np.abs(exact.error - fast.error).max() < 1e-9 * np.abs(command).max()
    assert (exact.status == fast.status).all()


@pytest.mark.slow
@pytest.mark.parametrize("compiler", BOTH)
@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_has_the_same_error_strictly_and_with_fast_arithmetic(tmp_path, kind, compiler):
    for seed in range(6):
        samples = KINDS[kind](600 + seed, 512)
        ours = compare(tmp_path / f"{seed}", samples, compiler)
        fast = build(tmp_path / f"{seed}", compiler, ("-std=c99", "-O3", "-ffast-math"))
        second = follow(fast, samples.command, samples.measured, samples.begin)
        assert (np.abs(ours.error - second.error) < 1e-9 * samples.peaks[:, np.newaxis]).all()


def require_sanitizer(folder, compiler, sanitizer):
    """Skip where a compiler came without the libraries of a sanitizer."""
    (folder / "empty.c").write_text("int main(void) { return 0; }\n")
    words = [compiler, f"-fsanitize={sanitizer}", "empty.c", "-o", "empty"]
    if subprocess.run(words, cwd=folder, capture_output=True, check=False).returncode:  # noqa: S603
        pytest.skip(f"{compiler} has no {sanitizer} sanitizer here")


def follow_sanitized(folder, samples, compiler, sanitizer):
    """Let the example follow a drawn test under a sanitizer, which ends it where it finds something."""
    build_monitor(samples.monitor, folder, compiler)
    table = np.stack([samples.command, samples.measured], axis=1).reshape(-1, samples.command.shape[1]).T
    names = ",".join(f"channel_{k}" for k in range(table.shape[1]))
    np.savetxt(folder / "test.csv", table, delimiter=",", header=names, comments="", fmt="%.17g")
    flags = [*STRICT, f"-fsanitize={sanitizer}", "-fno-sanitize-recover=all"]
    sources = ["reliab_monitor.c", "example.c", "-lm", "-o", "example"]
    require_sanitizer(folder, compiler, sanitizer)
    subprocess.run([compiler, *flags, *sources], cwd=folder, check=True)  # noqa: S603 - a compiler
    run = subprocess.run(["./example", "test.csv"], cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode in range(FAULT), run.stderr
    assert len(run.stdout.splitlines()) == samples.command.shape[1]
    assert len(run.stderr.splitlines()) == 1


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.parametrize("compiler", BOTH)
def test_sanitizers_find_nothing_in_the_example(tmp_path, compiler):
    follow_sanitized(tmp_path, draw_single_degree(8, 256), compiler, SANITIZERS[0])


@pytest.mark.slow
@pytest.mark.parametrize("compiler", BOTH)
@pytest.mark.parametrize("sanitizer", SANITIZERS)
@pytest.mark.parametrize("kind", KINDS)
def test_sanitizers_find_nothing_in_any_kind(tmp_path, kind, sanitizer, compiler):
    for seed in range(3):
        follow_sanitized(tmp_path / f"{seed}", KINDS[kind](700 + 5 * seed, 256), compiler, sanitizer)


@pytest.mark.slow
@pytest.mark.parametrize("compiler", BOTH)
@pytest.mark.parametrize("kind", KINDS)
def test_two_threads_step_two_monitors(tmp_path, kind, compiler):
    build_monitor(KINDS[kind](9, 256).monitor, tmp_path)
    require_sanitizer(tmp_path, compiler, "thread")
    (tmp_path / "two.c").write_text(TWO_THREADS)
    flags = [*STRICT, "-fsanitize=thread", "-pthread"]
    sources = ["reliab_monitor.c", "two.c", "-lm", "-o", "two"]
    subprocess.run([compiler, *flags, *sources], cwd=tmp_path, check=True)  # noqa: S603 - a compiler
    run = subprocess.run(["./two"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")


@pytest.mark.parametrize("compiler", BOTH)
@pytest.mark.parametrize("kind", [FIRST, *(pytest.param(kind, marks=pytest.mark.slow) for kind in FURTHER)])
def test_nothing_is_allocated_and_no_state_is_shared(tmp_path, kind, compiler):
    for name, text in monitor_sources(KINDS[kind](10, 256).monitor).items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    object_file = [compiler, *STRICT, "-c", "reliab_monitor.c", "-o", "monitor.o"]
    subprocess.run(object_file, cwd=tmp_path, check=True)  # noqa: S603
    listing = subprocess.run(
        ["nm", "monitor.o"],  # noqa: S607 - of the compiler
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    symbols = [line.split()[-2:] for line in listing.splitlines()]
    assert {name for kind, name in symbols if kind == "U"} <= MATH_FUNCTIONS | COMPILER_FUNCTIONS
    assert not {name for kind, name in symbols if kind in "BbDdC"}
