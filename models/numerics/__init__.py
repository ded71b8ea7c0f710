"""Numerical methods that machines share; nothing here depends on a machine."""
