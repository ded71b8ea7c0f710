"""Figures, one kind in a file; `uq.plots` is their public face.

Reading order; each part imports only those above it:

    figure              figures: their style, their layout and their files
    panel               panels of a new figure or within given axes
    words               words, units and symbols in figures and reports
    elements_plot       common parts of figures of elements
    line_labels         labels beside the lines that they name, and the note on an assumed scale
    index_plot          figures of sensitivity indices
    motion_plot         figures of a machine's motion
    response_plot       figures of a machine's response
    distribution_plots  figures of the distribution of an output
    life_plots          figures of lives by cause, on probability paper, beside simulated ones
    quantile_table      the table of quantiles of an output, and tables as files: CSV and LaTeX
    input_plot          the figure of the inputs: the stated law of each, and its sampled values
    scatter_plot        scatter plots
    catalogue           a figure of a result as an entry of a table
    convergence_plot    figures of convergence: estimates from ever more of the first rows
    share_plots         figures of shares of the rows
    subjects            the subjects of figures
"""
