"""The mole on paper: equations without any method of solving them.

Read `system` (the constants of one mole), `friction` (which interface slips, and the forces that
follow), `equations` (the rates of change within a mode), `periods` (control against mains).
"""
