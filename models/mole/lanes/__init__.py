"""The fast propagator: sixteen moles abreast.

Read `propagation` (the loop), then what it is made of: `block` (the memory of the lanes), `rates`
(their rates of change), `modes` (guards, and what an event changes), `steps` (what follows a trial
step), `rows` (how a row enters and leaves a lane).
"""
