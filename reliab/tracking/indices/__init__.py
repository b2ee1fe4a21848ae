"""Indices of actuator tracking and errors of the whole test."""
