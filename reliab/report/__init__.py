"""Figures and PDF reports of finished results; nothing is simulated here."""
