"""HTML: the answer, the report and the dossier, each one file that needs nothing else.

Reading order; each part imports only those above it:

    bars              a number as a bar with its interval, in HTML that needs no script
    keyed_sentences   sentences of the answer as HTML
    axes              axes of a page
    references        references that a model asks to cite
    encoded           arrays as text inside a page: base64 of their bytes
    symbols           symbols of formulas as HTML
    first_scatter     the scatter plot that a page shows first
    moved_laws        arguments of a law with another scatter or another middle
    inspections       the inspections from which a result was learnt
    paths             paths of a drawing, written with few characters
    cells             tables of a report, in plain data that the template lays out
    folded            secondary parts of the answer, as HTML to be unfolded
    embedded_columns  the columns of numbers inside a page
    tolerances        other tolerances
    indices           sensitivities in a report: one table for each target of each method
    pictures          figures of a page: embedded SVG, or an image if the SVG would be too large
    fleets            fleets in a report: as many units as a sample has
    inputs            the inputs in a report: laws, sources, and how well each number is known
    levels            variance by level in a report: shared, own, or due to chance
    outcomes          the rows in a report: how they ended, and the statistics of the outputs
    answer            the answer as HTML, for a notebook and for the head of a report
    embedded_rows     the rows inside a page, with which its scripts (``live/``) compute
    convergence       convergence in a report
    head              the head of a report
    layout            the templates of pages, and what every page on a result shows
    output_tables     all that a report says of one output
    dossier           the contents of a report
    page              the content of the page, which the template beside this file lays out
"""
