"""What is not known exactly about a test, and how much of the interval of its error that makes."""
