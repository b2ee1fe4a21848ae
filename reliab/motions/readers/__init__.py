"""Readers of record files: one format per file, chosen by content.

A reader finds out what a header says (`Header`); the samples themselves are parsed in one place for all
formats.
"""
