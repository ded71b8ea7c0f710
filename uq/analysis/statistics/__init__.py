"""The statistics of an output: `table` lists them, `statistic` says what one is."""
