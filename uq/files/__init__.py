"""Checked paths and whole writes, journals, checksums, and netCDF files from anyone.

Reading order; each part imports only those above it:

    interrupts    clean-up of interrupted work: no temporary files or processes remain
    journal       an append-only journal: one record per line, each with its own checksum
    netcdf_files  netCDF files from untrusted sources
    whole_files   paths checked before writing, and files written completely or not at all
"""
