"""HTML: the answer, the report and the dossier, each one file that needs nothing else.

Reading order; each part imports only those above it:

    cells             tables of a report, in plain data that the template lays out
    keyed_sentences   sentences of facts as HTML with the keys of their numbers
    embedded_columns  columns of numbers inside a page: their names, axes and bytes
    moved_laws        arguments of a law with another scatter or another middle
    indices           sensitivities in a report: one table for each target of each method
    answer            the answer as HTML, for a notebook, a dossier and a report
    first_screen      the card of a result on a page: tiles of its numbers, a table of its causes
    inputs            the inputs in a report: laws, sources, and the quality of each number
    tolerances        other tolerances
    pictures          figures of a page: embedded SVG, or an image if the SVG would be too large
    embedded_rows     rows inside a page, with which its scripts (``live/``) compute
    outcomes          rows in a report
    convergence       convergence, variance by level, and fleets in a report
    page              report of a result as one HTML file
    dossier           the contents of a report
"""
