"""Checked paths and whole writes, journals, checksums, and netCDF files from anyone.

Reading order; each part imports only those above it:

    interrupts    work that can be stopped at any moment without leaving anything behind
    journal       an append-only journal: one record per line, each with its own checksum
    netcdf_files  files in netCDF that may come from anyone: examined before they are opened
    paths         checks of paths before reading or writing
    seal          a checksum of the content of a netCDF file, kept in the file itself
    whole_files   files written completely or not at all
"""
