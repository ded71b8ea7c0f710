"""Everything that the platform computes and reports, recorded, to compare two states of the code.

``python -m benchmarks.record run FOLDER`` runs every shipped study at a reduced size, and small
studies of every design, into a folder. ``... read FOLDER OUT.json`` records the bits of every
variable in these results, and what every verb reports of them, as JSON and as text. ``... compare
A.json B.json`` prints what differs. Results made by one state of the code can be read by another:
old results then print the same. A regular expression as the last argument selects by name. All of
it takes about half an hour of one core.
"""
