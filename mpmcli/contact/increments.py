"""Contact on the velocity increments of FMPM(k): the "Net" and "Evolving" methods (Nairn 2026, 3.2).

For every contact two vectors are kept through the loop of a step: ``prior``, the Δp(0) that brings the velocity so far
to that of the centre of mass, and ``net``, the sum of the contact's impulses so far. "Net" takes the velocity before
contact ever acted on it, "Evolving" at the one that contact has corrected. The other ways of a scene, "lumped", "after"
and "combined", correct whole velocities and need nothing of this.
"""

from mpmcli.core.compiled.kernel import inline


@inline
def start_increments(axes, evolving, dp0, found, prior, net):
    """Begin with the lumped-mass calculation: it was handed ``dp0`` and gave ``found``, all (d,) [momentum].

    Overwrites ``prior`` and ``net`` (d,).
    """
    for a in range(len(axes)):
        net[a] = found[a]
        prior[a] = dp0[a] - found[a] if evolving else dp0[a]


@inline
def total_increment(axes, prior, own, total):
    """Δp*(0) of an increment, which is what ``law_impulse`` is handed (Nairn 2026, Eq. 20), into ``total`` (d,).

    ``own`` (d,) is m_red (Δv_β − Δv_α) of the increment alone, before contact.
    """
    for a in range(len(axes)):
        total[a] = prior[a] + own[a]


@inline
def finish_increment(axes, evolving, own, total, found, prior, net, effective):
    """Momentum that contact adds to α for the increment, into ``effective`` (d,); ``prior``, ``net`` move on.

    "Net": Δp_eff = Δp(ℓ) − Δp_net, written as the increment's own part and the change of what contact lets slip; so a
    contact that sticks takes the increment to the centre of mass to the last digit. "Evolving": Δp_eff = Δp(ℓ).
    """
    for a in range(len(axes)):
        if evolving:
            effective[a] = found[a]
            prior[a] = total[a] - found[a]
            net[a] += found[a]
        else:
            effective[a] = own[a] + ((found[a] - total[a]) - (net[a] - prior[a]))
            prior[a] = total[a]
            net[a] = found[a]
