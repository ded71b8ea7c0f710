"""HTML: the answer, the report and the dossier, each one file that needs nothing else.

Reading order; each part imports only those above it:

    bars             a number as a bar with its interval, in HTML that needs no script
    keyed_sentences  sentences of the answer as HTML
    paths            paths of a drawing, written with few characters
    references       what a model asks to cite
    inspections      the inspections from which a result was learnt
    symbols          symbols of formulas as HTML
    first_scatter    what the scatter plot of a page shows first
    tolerances       what a page needs to weight its rows
    cells            tables of a report, in plain data that the template lays out
    folded           what is secondary in the answer, as HTML to be unfolded
    pictures         figures of a page: embedded SVG, or an image if the SVG would be too large
    embedded_rows    the rows inside a page, with which its scripts (``live/``) compute
    levels           what is shared, own, or due to chance, in a report
    inputs           the inputs in a report: laws, sources, and how well each number is known
    fleets           what a report says of fleets: as many units as a sample has
    outcomes         the rows in a report: how they ended, and the statistics of the outputs
    indices          sensitivities in a report: one table for each target of each method
    answer           the answer as HTML, for a notebook and for the head of a report
    convergence      convergence in a report
    head             the head of a report
    layout           the templates of pages, and what every page on a result shows
    output_tables    all that a report says of one output
    dossier          the contents of a report
    page             the content of the page, which the template beside this file lays out
"""
