"""One step of a Rosenbrock method of order 5(4) for laws with a memory that are fast: stiff bristles. Compiled.

Coefficients: Rodas5P of Steinebach (2023), BIT Numerical Mathematics 63, 27; L-stable, with an interpolant of order 4.
What is slower than the step is followed; what is faster is where it would have gone.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from spacerobot.simulation.reduced.arrays import (
    FORCES,
    FRICTIONS,
    INPUTS,
    MASS,
    STATE_LINEAR,
    STATE_PORT,
    STATES,
    W_ROWS,
    D,
    N,
    V,
    Z,
)
from spacerobot.simulation.reduced.forces import remember
from spacerobot.simulation.reduced.motion import accelerate
from spacerobot.support.jit import lean

STAGES = 8
GAMMA = 0.21193756319429014
_LAST = (-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946)
_A = np.zeros((STAGES, STAGES))
_A[1, 0] = 3.0
_A[2, :2] = 2.849394379747939, 0.45842242204463923
_A[3, :3] = -6.954028509809101, 2.489845061869568, -10.358996098473584
_A[4, :4] = 2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641
_A[5, :5] = _LAST
_A[6, :6] = *_LAST, 1.0
_A[7, :7] = *_LAST, 1.0, 1.0
_C = np.zeros((STAGES, STAGES))
_C[1, 0] = -14.155112264123755
_C[2, :2] = -17.97296035885952, -2.859693295451294
_C[3, :3] = 147.12150275711716, -1.41221402718213, 71.68940251302358
_C[4, :4] = 165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306
_C[5, :5] = 24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471
_C[6, :3] = 30.91273214028599, -3.1208243349937974, 77.79954646070892
_C[6, 3:6] = 34.28646028294783, -19.097331116725623, -28.087943162872662
_C[7, :3] = 37.80277123390563, -3.2571969029072276, 112.26918849496327
_C[7, 3:7] = 66.9347231244047, -40.06618937091002, -54.66780262877968, -9.48861652309627
_AT = np.array([0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0])
_DRIFT = np.array(
    [GAMMA, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734, 2.325825639765069, 0.0, 0.0, 0.0]
)
_BEND = np.zeros((3, STAGES))
_BEND[0, :4] = 25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204
_BEND[0, 4:] = 0.524948541321073, 1.1241088310450404, 0.4272876194431874, -0.17202221070155493
_BEND[1, :4] = -9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796
_BEND[1, 4:] = 20.176138334709044, 15.98066361424651, -6.789040303419874, -6.710236069923372
_BEND[2, :4] = 11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643
_BEND[2, 4:] = -52.072871366152654, -59.78993625266729, -0.15582684282751913, 4.883087185713722

STABLE = 2.0
"""Fastest rate times step from which on this method is taken; the explicit one is stable up to 3.3."""


LOOSE = 100.0
"""How much more than `atol` a state may err where its force does nothing of it to the motion."""


class Room(NamedTuple):
    """Work arrays. n coordinates, S states, N = 2n + S."""

    slope: np.ndarray  # (n + S, N) of the accelerations and the rates of the states
    matrix: np.ndarray  # (n + S, n + S)
    right: np.ndarray  # (n + S,)
    drift: np.ndarray  # (N,) change of the right-hand side with time
    pair: np.ndarray  # (2, N)


@lean
def hastiness(x: Any, c: Any, laws: Any, y: Any, modes: Any, w: Any, rtol: float, atol: Any, scale: Any) -> float:
    """Bound of the fastest rate that laws with a memory bring at the state last evaluated [1/s].

    Fills the last of `scale`, shape of y, with the error of each state that is tolerated in a step: `atol`, or what its
    force may do to the speed of its port before it is forgotten, if that is more, up to LOOSE times as much.
    """
    n, first, fastest = c[N], 1 + c[FORCES] + c[FRICTIONS], 0.0
    for s in range(c[STATES]):
        p, way = c[c[STATE_PORT] + s], 1.0 * modes[first + s]
        z, d, v = w[c[Z] + s], w[c[D] + p], w[c[V] + p]
        dz, dv = max(1e-6 * abs(z), atol[2 * n + s]), max(1e-6 * abs(v), atol[n])
        rate, force = remember(x, c, laws, s, z, d, v, way, 1.0)
        by_z = remember(x, c, laws, s, z + dz, d, v, way, 1.0)
        by_v = remember(x, c, laws, s, z, d, v + dv, way, 1.0)
        give = 0.0
        for i in range(n):
            give += w[c[W_ROWS] + p * n + i] ** 2 * x[c[MASS] + i]
        spring = abs((by_z[1] - force) / dz * (by_v[0] - rate) / dv)
        forgets, swings = abs(by_z[0] - rate) / dz, np.sqrt(give * spring)
        fastest += forgets + give * abs(by_v[1] - force) / dv + swings
        pull = give * abs(by_z[1] - force) / dz
        least, most = atol[2 * n + s], LOOSE * (atol[2 * n + s] + rtol * abs(z))
        scale[2 * n + s] = max(least, min(most, (atol[n] + rtol * abs(v)) * (forgets + swings) / max(pull, 1e-300)))
    return fastest


@lean
def remembers(c: Any) -> bool:
    """Whether any law with a memory bends."""
    found = False
    for s in range(c[STATES]):
        found |= c[c[STATE_LINEAR] + s] == 0
    return found


@lean
def linearise(
    x: Any, c: Any, laws: Any, t: float, y: Any, modes: Any, u: Any, w: Any, k: Any, atol: Any, o: Any
) -> None:
    """Slopes of the right-hand side at (t, y), where it is k, by differences."""
    n, size = c[N], y.size
    moved, found = o.pair[0], o.pair[1]
    for i in range(size):
        moved[i] = y[i]
    for j in range(size):
        probe = max(1e-7 * abs(y[j]), atol[j])
        moved[j] = y[j] + probe
        accelerate(x, c, laws, t, moved, modes, u, w, found)
        moved[j] = y[j]
        for i in range(n, size):
            o.slope[i - n, j] = (found[i] - k[i]) / probe
    for i in range(size):
        o.drift[i] = 0.0
    if c[INPUTS] > 0:
        accelerate(x, c, laws, t + 1e-7, y, modes, u, w, found)
        for i in range(size):
            o.drift[i] = (found[i] - k[i]) / 1e-7


@lean
def _factorise(h: float, n: int, o: Any) -> None:
    """The triangles of 1/(gamma h) - slopes, the positions taken out."""
    m, g = o.matrix.shape[0], GAMMA * h
    for i in range(m):
        for j in range(m):
            o.matrix[i, j] = -o.slope[i, n + j] - (g * o.slope[i, j] if j < n else 0.0)
        o.matrix[i, i] += 1.0 / g
    for k in range(m):
        for i in range(k + 1, m):
            o.matrix[i, k] /= o.matrix[k, k]
            for j in range(k + 1, m):
                o.matrix[i, j] -= o.matrix[i, k] * o.matrix[k, j]


@lean
def _solve(h: float, n: int, o: Any, b: Any) -> None:
    """b = (1/(gamma h) - slopes)^-1 b."""
    m, g = o.matrix.shape[0], GAMMA * h
    for i in range(m):
        o.right[i] = b[n + i]
        for j in range(n):
            o.right[i] += g * o.slope[i, j] * b[j]
        for j in range(i):
            o.right[i] -= o.matrix[i, j] * o.right[j]
    for a in range(m):
        i = m - 1 - a
        for j in range(i + 1, m):
            o.right[i] -= o.matrix[i, j] * o.right[j]
        o.right[i] /= o.matrix[i, i]
    for i in range(n):
        b[i] = g * (b[i] + o.right[i])
    for i in range(m):
        b[n + i] = o.right[i]


@lean
def stiff_stages(
    x: Any, c: Any, laws: Any, t: float, y: Any, h: float, modes: Any, u: Any, w: Any, k: Any, o: Any, new: Any
) -> None:
    """A step of length h from (t, y), where the slope is k[0]; the stages are left in k[1:], its end in `new`."""
    size, n = y.size, c[N]
    _factorise(h, n, o)
    for s in range(STAGES):
        stage = k[1 + s]
        if s == 0:
            for i in range(size):
                stage[i] = k[0, i]
        else:
            for i in range(size):
                total = y[i]
                for j in range(s):
                    total += _A[s, j] * k[1 + j, i]
                new[i] = total
            accelerate(x, c, laws, t + _AT[s] * h, new, modes, u, w, stage)
        for i in range(size):
            total = stage[i] + h * _DRIFT[s] * o.drift[i]
            for j in range(s):
                total += _C[s, j] / h * k[1 + j, i]
            stage[i] = total
        _solve(h, n, o, stage)
    for i in range(size):
        new[i] += k[STAGES, i]


@lean
def stiff_norm(y: Any, new: Any, k: Any, rtol: float, atol: Any) -> float:
    """Largest error of the step over its tolerance; at most 1 is accepted."""
    worst = 0.0
    for i in range(y.size):
        error = abs(k[STAGES, i]) / (atol[i] + rtol * max(abs(y[i]), abs(new[i])))
        if not error <= worst:  # what is not a number among them
            worst = error
    return worst


@lean
def stiff_dense(y: Any, new: Any, h: float, k: Any, q: Any) -> None:
    """Coefficients of the interpolant, as `stepper.dense` has them."""
    for i in range(y.size):
        one, two, three = 0.0, 0.0, 0.0
        for j in range(STAGES):
            one += _BEND[0, j] * k[1 + j, i]
            two += _BEND[1, j] * k[1 + j, i]
            three += _BEND[2, j] * k[1 + j, i]
        q[i, 0] = (new[i] - y[i] + one) / h
        q[i, 1] = (two - one) / h
        q[i, 2] = (three - two) / h
        q[i, 3] = -three / h
