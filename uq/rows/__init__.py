"""Rows of a study: drawn, evaluated, laid out in a result."""
