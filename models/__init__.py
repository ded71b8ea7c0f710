"""The machines: they know nothing of sampling, dask, files or xarray."""
