"""Flows: where a response is near no stable orbit, its gaps grow all the time.

They grow many times faster than in reality, and the time that passes is that of real wear at the
running rate. Blocks of a flow are taken as steps over which the rate jumps. So the error of a flow
covers the scatter of aperiodic wear, and changes of the response, which it follows too late.
"""

from models.beam.wear.progress import FIRST_STEP, KEEP, ONWARD, STEPPING, wear_on
from models.numerics.jit import inlined

_APPROACHING = 4  # rounds in which the response must come closer to an orbit
_MEMORY = 0.25  # weight of the newest round in a running rate
_BLOCK = 4  # rounds


@inlined
def begin_flow(i, life):
    """Prepare for the first round of a flow."""
    life.rounds[i] = 0
    for k in range(4):
        life.block[i, k] = 0.0
    for s in range(2):
        life.block_inverse[i, s] = 0.0


@inlined
def flow(i, life, out, now, grown, nearing, regime, spacing):
    """Let the time of a round of a flow pass; end the flow where the response nears an orbit."""
    life.regime[i] = regime
    life.block[i, 2] += life.span[i]
    life.block[i, 3] += 1
    for s in range(2):
        life.block[i, s] += grown[s]
    if life.block[i, 3] == _BLOCK:
        _end_block(i, life)
    wear_on(i, life, out, life.span[i], grown, life.rate[i], spacing)
    for s in range(2):
        life.rate[i, s] += _MEMORY * (now[s] - life.rate[i, s])
    life.rounds[i] = life.rounds[i] + 1 if nearing else 0
    if life.rounds[i] < _APPROACHING or now[0] + now[1] == 0:
        return ONWARD
    life.mode[i] = STEPPING
    life.step[i] = FIRST_STEP
    for s in range(2):
        life.rate[i, s] = now[s]
        life.rate_before[i, s] = 0.0
    return KEEP


@inlined
def _end_block(i, life):
    """Add the error of a block: as of a step over which the rate jumps.

    A site that is not touched waits for the other: its clock has the other's error.
    """
    time = life.block[i, 2]
    for s in range(2):
        grown = life.block[i, s]
        inverse = time / grown if grown > 0 else 0.0
        life.error[i, s] = 0.0
        if inverse > 0 and life.block_inverse[i, s] > 0:
            life.error[i, s] = min(time, grown * abs(inverse - life.block_inverse[i, s]) / 2)
        life.block_inverse[i, s] = inverse
    for s in range(2):
        waits = life.block[i, s] <= 0
        error = life.error[i, 1 - s] if waits else life.error[i, s]
        life.flow_error[i, s] += error**2
    for k in range(4):
        life.block[i, k] = 0.0
