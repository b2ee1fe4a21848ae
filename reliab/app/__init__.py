"""Questions and how they are asked: functions of Python, and commands."""
