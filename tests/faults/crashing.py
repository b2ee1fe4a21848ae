"""Run the command line in a process that is killed, or starved of disk, at a chosen write.

Python announces every opening of a file and every renaming to audit hooks. The process kills itself, as
`kill -9` would, at the n-th announcement of a write below the folder of results, so that every instant
between two writes can be tried in turn, instead of instants that a clock happens to choose. HDF5 files are
announced when they are opened and before they are closed, when a part of what was written is not on the disk.

Processes are forked from one that has imported everything, which saves most of their time.
"""

import errno
import importlib
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

_NOBODY = 65534
_MODULES = (
    "encodings.utf_8_sig",  # which another user may be unable to import later
    *(
        "arviz_stats",
        "emcee",
        "h5netcdf",
        "matplotlib.pyplot",
        "typst",
        "zarr",
        "rich.table",
        "reliab.app.api",
    ),
    *(
        "reliab.criterion",
        "reliab.discrepancy",
        "reliab.explore.page",
        "reliab.report.kinds.discrepancy_report",
    ),
    *("reliab.study", "reliab.sweep", "reliab.validation"),
)
ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Outcome:
    """How a process ended, what it said, how long it took [s], and how often it wrote."""

    code: int
    errors: str
    seconds: float = 0.0

    @property
    def writes(self) -> int:
        return int(self.errors.rsplit("WRITES", 1)[1])


class Forks:
    """A process that forks one for every command."""

    def __init__(self) -> None:
        self._server = subprocess.Popen(  # noqa: S603 - this very file
            [sys.executable, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def run(
        self, arguments: Sequence[object], folder: Path, *, instant: float = 0, action: str = "kill"
    ) -> Outcome:
        """Run a command line.

        Parameters
        ----------
        arguments : sequence
            What stands after `reliab`.
        folder : pathlib.Path
            The folder below which writes are counted.
        at : float, optional
            The write at which something happens; 0 for never.
        action : str, optional
            What happens: kill, terminate, vanish (the folder is removed) or full (the disk is). For "clock"
            `at` is the time after which the process is killed [s], for "quota" the largest file [bytes], for
            "sampling" the steps of chains after which they are kept and the process is killed; with
            "readonly" it may not write to the folder.
        """
        request = {
            "arguments": [*map(str, arguments)],
            "folder": str(folder),
            "at": instant,
            "action": action,
        }
        print(json.dumps(request), file=self._server.stdin, flush=True)
        return Outcome(**json.loads(self._server.stdout.readline()))

    def close(self) -> None:
        self._server.communicate()


def command(arguments: Sequence[object], environment: dict[str, str]) -> Outcome:
    """Run a command line in a new process with variables of its own."""
    program = "import sys; from reliab.app.cli import main; sys.argv[0] = 'reliab'; main()"
    process = subprocess.run(  # noqa: S603 - this very package
        [sys.executable, "-c", program, *map(str, arguments)],
        capture_output=True,
        check=False,
        env={**os.environ, **environment},
    )
    return Outcome(process.returncode, process.stderr.decode(errors="replace"))


class _Fault:
    """Something that happens at the n-th write below a folder."""

    def __init__(self, folder: str, instant: int, action: str) -> None:
        self.folder, self.instant, self.action, self.writes = folder, instant, action, 0

    def __call__(self, event: str, arguments: tuple[object, ...]) -> None:
        if event == "open":
            writes = bool(int(arguments[2]) & (os.O_WRONLY | os.O_RDWR | os.O_CREAT))
        else:
            writes = event in {"os.rename", "os.remove", "os.mkdir"}
        name = arguments[0] if writes else None
        if isinstance(name, str | bytes) and os.path.abspath(os.fsdecode(name)).startswith(self.folder):  # noqa: PTH100
            self.writes += 1
            if self.action == "full" and event in {"os.rename", "os.remove"}:
                self.instant += self.writes == self.instant  # neither needs room
            elif self.writes == self.instant:
                self._happen(os.fsdecode(name))

    def _happen(self, name: str) -> None:
        match self.action:
            case "kill":
                os.kill(os.getpid(), signal.SIGKILL)
            case "terminate":
                os.kill(os.getpid(), signal.SIGTERM)
            case "vanish":
                shutil.rmtree(self.folder, ignore_errors=True)
            case "full":
                self.instant += 1  # it stays full
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), name)


def _announce_hdf5() -> None:
    import h5py

    opening, closing = h5py.File.__init__, h5py.File.close

    def open_announced(self, name, mode="r", *positional, **options):
        self.announced = os.fspath(name) if mode != "r" and isinstance(name, str | os.PathLike) else ""
        if self.announced:
            sys.audit("open", self.announced, mode, os.O_RDWR)
        opening(self, name, mode, *positional, **options)

    def close_announced(self):
        if self.announced:
            sys.audit("open", self.announced, "r+", os.O_RDWR)
        closing(self)

    h5py.File.__init__, h5py.File.close = open_announced, close_announced


def _kill_while_sampling(steps: int) -> None:
    """Kill this process after so many steps of chains, which are kept as if some seconds had passed."""
    from reliab.sampling.ensembles import ChainFile

    count = 0

    def save(file, **_):
        nonlocal count
        count += 1
        if count == steps:
            file._write()  # noqa: SLF001 - what it does every few seconds
            os.kill(os.getpid(), signal.SIGKILL)

    ChainFile.save = save


def _serve() -> None:
    """Fork for every line of standard input; answer with how the child ended."""
    for name in _MODULES:
        importlib.import_module(name)
    _announce_hdf5()
    for line in sys.stdin:
        request = json.loads(line)
        with tempfile.TemporaryFile() as errors:
            start = time.monotonic()
            child = os.fork()
            if child == 0:
                _run(request, errors.fileno())
            status = _wait_for(child, request)
            errors.seek(0)
            text = errors.read().decode(errors="replace")
        answer = {
            "code": os.waitstatus_to_exitcode(status),
            "errors": text,
            "seconds": time.monotonic() - start,
        }
        print(json.dumps(answer), flush=True)


def _wait_for(child: int, request: dict) -> int:
    """Wait for a child, and kill it when its time is over."""
    clock = threading.Timer(request["at"], os.kill, (child, signal.SIGKILL))
    if request["action"] == "clock":
        clock.start()
    os.waitid(os.P_PID, child, os.WEXITED | os.WNOWAIT)
    clock.cancel()
    return os.waitpid(child, 0)[1]


def _run(request: dict, errors: int) -> None:
    from reliab.app.cli import run

    os.dup2(errors, 2)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    fault = _Fault(request["folder"], request["at"], request["action"])
    sys.addaudithook(fault)
    if request["action"] == "quota":
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (int(request["at"]), resource.RLIM_INFINITY))
    elif request["action"] == "sampling":
        _kill_while_sampling(int(request["at"]))
    elif request["action"] == "readonly" and os.geteuid() == 0:
        os.setuid(_NOBODY)
    code = 70
    try:
        code = run(request["arguments"])
    except BaseException:  # noqa: BLE001 - printed for the test
        import traceback

        traceback.print_exc()
    print("WRITES", fault.writes, file=sys.stderr, flush=True)
    os._exit(code)


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    _serve()
