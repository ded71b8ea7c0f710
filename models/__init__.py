"""The machines, independent of sampling, dask, files and xarray."""
