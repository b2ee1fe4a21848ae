"""A digital laboratory: numerical substructure, controller, transfer system and specimen, step by step."""
