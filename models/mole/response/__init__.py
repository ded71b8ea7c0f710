"""The settled response of n moles, by the fast propagator.

Read `settling` (when the start is forgotten, and what is averaged then), `verdict` (what a motion
is that does not repeat).
"""
