"""The recording of a test: its channels read from a laboratory's file and checked."""
