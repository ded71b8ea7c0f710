"""The contents of a report, ordered along published outlines for probabilistic assessments.

Reading order; each part imports only those above it:

    outline     headings of a dossier, the documents that they follow
    assessment  the assessed system: context, quantities, software, models, inputs
    chapters    chapters of a dossier
"""
