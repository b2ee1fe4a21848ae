"""Tests of the rebuilt error, with a laboratory of their own that imports nothing of the product."""
