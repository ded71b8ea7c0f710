"""Checked paths and whole writes, journals, checksums, and netCDF files from anyone.

Reading order; each part imports only those above it:

    paths         checks of paths before reading or writing
    interrupts    work that can be stopped at any moment without leaving anything behind
    netcdf_files  files in netCDF that may come from anyone: examined before they are opened
    seal          a checksum of the content of a netCDF file, kept in the file itself
    journal       an append-only journal: one record per line, each with its own checksum
    whole_files   files written completely or not at all
"""
