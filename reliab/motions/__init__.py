"""Ground motions: readers, catalogues, suites, resampling and measures of intensity."""
