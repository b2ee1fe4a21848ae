"""Run `command_line.py` as a plain script, whatever the working directory."""

import sys
from pathlib import Path

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
    from blind_campaigns.command_line import main

    main()
