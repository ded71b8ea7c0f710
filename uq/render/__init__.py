"""Figures and HTML pages, and traces of numbers.

Reading order; each part imports only those above it:

    card     the card of a result as lines of 80 columns, in a terminal and in a notebook
    figures  figures, one kind in a file; `uq.plots` is their public face
    trace    traces: where a number comes from, and the same number computed again
    html     HTML: the answer, the report and the dossier, each one file that needs nothing else
"""
