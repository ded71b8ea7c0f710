"""Rows carried out: here, in processes of their own, on dask workers."""
