"""Figures, one kind in a file; `uq.plots` is their public face.

Reading order; each part imports only those above it:

    figure              figures: their style, their layout and their files
    panel               panels of a figure: their ticks, titles and legend
    words               words, units and symbols in figures and reports
    elements_plot       styles, titles, units, bins and regimes common to figures of elements
    index_plot          sensitivity indices as bars, and along a dimension of an output
    motion_plot         time histories, phase portraits and Poincaré sections
    response_plot       curves, bifurcation diagrams and basins of attraction
    distribution_plots  histograms, of lives in particular, and a table of quantiles
    input_plot          the figure of the inputs: the stated law of each, and its sampled values
    scatter_plot        an output against its most influential inputs, and inputs by regime
    catalogue           a figure as an entry of a table: subjects, caption, place
    convergence_plot    figures of convergence: estimates from ever more of the first rows
    share_plots         shares of the rows by label, and of an event over its leading input
    subjects            the subjects of figures
"""
