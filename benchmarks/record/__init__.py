"""Everything that the platform computes and reports, recorded, to compare two states of the code.

``python -m benchmarks.record run FOLDER`` runs every shipped study at a reduced size, and small
studies of every design, into a folder. ``... read FOLDER OUT.json`` records the bits of every
variable in these results, and what every verb reports of them, as JSON and as text. ``... compare
A.json B.json`` prints what differs, numbers first. Results made by one state of the code can be
read by another: old results then print the same.

A regular expression as the last argument selects groups of entries, by result or by kind: ``quick``
stands for a few that cover most of the code, in two minutes; all of it takes a quarter of an hour
of one core. Only commands and public functions are used, and names of modules and folders, and
hashes of code, are left out: one version of this package records any state of the code.

Reading order; each part imports only those above it:

    command    a command of ``uq``, carried out in a fork of this process
    plain      texts and JSON without what depends on the computer, the place and the time
    studies    the studies that are recorded
    verbs      commands that are recorded, of each result and of some
    mistakes   commands that are refused
    entries    entries of the record
    comparing  differences between two records
"""
