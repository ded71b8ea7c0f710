"""HTML: the answer, the report and the dossier, each one file that needs nothing else.

Reading order; each part imports only those above it:

    cells             tables of a report, in plain data that the template lays out
    keyed_sentences   sentences of facts as HTML with the keys of their numbers
    embedded_columns  columns of numbers inside a page: their names, axes and bytes
    moved_laws        laws with another scatter or middle, for each stop of a slider
    indices           sensitivities in a report: one table for each target of each method
    answer            the answer as HTML, for a notebook and for the head of a report
    inputs            the inputs in a report: laws, sources, and how well each number is known
    tolerances        weights of rows for each stop of a slider, and estimates there
    levels            variance by level in a report, and fleets of as many units
    pictures          figures of a page: embedded SVG, or an image if the SVG would be too large
    embedded_rows     rows inside a page, with which its scripts (``live/``) compute
    outcomes          how rows ended, and the tables, figures and sentences of each output
    convergence       running estimates in a report, and the errors of the rows
    page              the report as one HTML file: its content, and its templates
    dossier           the contents of a report
"""
