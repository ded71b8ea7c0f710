"""Figures, one kind in a file; `uq.plots` is their public face.

Reading order; each part imports only those above it:

    style               the style of figures: their width and fonts, colours, lines and points
    words               words, units and symbols in figures and reports
    figure              a figure: its layout and its files
    quantities          quantities of a Dataset on axes: their labels, units and scales
    panel               panels of a new figure or within given axes
    elements_plot       common parts of figures of elements
    index_plot          the figure of sensitivity indices
    motion_plot         figures of a machine's motion
    response_plot       figures of a machine's response
    distribution_plots  figures of the distribution of an output
    input_plot          the figure of the inputs: the stated law of each, and its sampled values
    scatter_plot        scatter plots
    shares_plot         the figure of the shares of a category
    catalogue           a figure of a result as an entry of a table
    convergence_plot    figures of convergence: estimates from ever more of the first rows
    event_plot          the figure of the probability of an event over the input that decides it
    index_curve_plot    the figure of sensitivity indices along a dimension of an output
    subjects            the subjects of figures
"""
