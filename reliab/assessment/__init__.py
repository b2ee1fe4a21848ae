"""The verdict on a real test, and what is tolerable before one."""
