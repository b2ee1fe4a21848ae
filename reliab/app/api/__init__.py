"""What Python users and commands ask for: one function for each question, in one vocabulary."""
