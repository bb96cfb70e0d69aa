"""A linear spring that moves by itself within a step, together with the forces of the step (Nairn 2023, 5.3).

The opening obeys δ″ + φ² δ = w over τ = t/Δt from 0 to 1, with φ² = D A Δt²/m_red and w = f Δt²/m_red; at the start it
is δ(0), with the rate d. Contacts of finite stiffness and interfaces use these formulas. They are written with
Stumpff's functions, without differences of near equals.
"""

import math

from mpmcli.core.compiled.kernel import inline

C3_TERMS = tuple((-1.0) ** k / math.factorial(2 * k + 3) for k in range(12))
C4_TERMS = tuple((-1.0) ** k / math.factorial(2 * k + 4) for k in range(12))


@inline
def stumpff(u):
    """c₂ = (1 − cos φ)/φ², c₃ = (1 − sin φ/φ)/φ² and c₄ = (½ − c₂)/φ² for u = φ² up to (π/2)², by their series."""
    c3, c4 = 0.0, 0.0
    for k in range(len(C3_TERMS) - 1, -1, -1):
        c3 = c3 * u + C3_TERMS[k]
        c4 = c4 * u + C4_TERMS[k]
    return 0.5 - u * c4, c3, c4


@inline
def end_opening(opening, free, pushed, u, c2, c3):
    """δ(Δt) of a spring with φ² = ``u`` (Nairn 2023, Eqs. 5.46, 5.150) [length].

    ``opening`` is δ(0), ``free`` = Δp⁺ Δt/m_red and ``pushed`` = f Δt²/m_red, all lengths.
    """
    return opening * (1.0 - u * c2) + free * (1.0 - u * c3) + pushed * (c2 + u * c3 - 1.0)


@inline
def mean_opening(opening, free, pushed, c2, c3, c4):
    """Half the opening whose force, held all the step, gives the impulse of the spring (Eqs. 5.45, 5.149) [length]."""
    return opening * c2 + free * c3 + pushed * (c4 - c3)
