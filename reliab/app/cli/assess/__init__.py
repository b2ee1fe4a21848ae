"""`reliab assess`: the verdict on a test, or what is tolerable before one."""
