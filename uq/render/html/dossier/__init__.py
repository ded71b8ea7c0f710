"""The contents of a report, ordered along published outlines for probabilistic assessments.

Reading order; each part imports only those above it:

    items       one thing that is expected under a heading of a dossier
    outline     the headings of a dossier, and the documents that they follow
    assessment  the assessed system: context, quantities, software, models, inputs
    results     results: propagation, convergence, sensitivities, uncertainty, conclusions
    chapters    the chapters of a dossier, in the order of the outline, and as HTML
"""
