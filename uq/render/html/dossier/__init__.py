"""The contents of a report, ordered along published outlines for probabilistic assessments.

Reading order; each part imports only those above it:

    outline     the headings of a dossier, and the documents that they follow
    items       one thing that is expected under a heading of a dossier
    results     what was found
    assessment  what was assessed: context, quantities, software, models, inputs
    chapters    the chapters of a dossier, in the order of the outline, and as HTML
"""
