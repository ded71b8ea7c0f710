"""The contents of a report, ordered along published outlines for probabilistic assessments.

Reading order; a module imports only those above it:

    outline      the headings, and the documents that they follow
    items        one thing that is expected under a heading: its contents, or nothing
    assessed     what was assessed: context, quantities, software, models, inputs
    found        what was found: propagation, convergence, sensitivities, uncertainty, conclusions
    chapters     all of it, and as HTML
"""

from uq.report.dossier.chapters import dossier

__all__ = ["dossier"]
