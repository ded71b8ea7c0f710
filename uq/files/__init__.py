"""Checked paths and whole writes, journals, checksums, and netCDF files from anyone.

Reading order; each part imports only those above it:

    interrupts    work that can be stopped at any moment without leaving anything behind
    journal       an append-only journal: one record per line, each with its own checksum
    netcdf_files  netCDF files from anyone
    whole_files   paths checked before writing, and files written completely or not at all
"""
