"""The program `reliab`, also as `python -m reliab`."""

import sys

from reliab.errors import INTERRUPTED


def main() -> None:
    """Run the command line; Ctrl-C ends it with one sentence, also while modules are still imported."""
    try:
        from reliab.cli import main as command_line

        command_line()
    except KeyboardInterrupt:
        sys.stderr.write("Interrupted.\n")
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
