"""Lines of sight cross chains or not: against exact fractions, with ties of every kind."""

import itertools
from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mpmcli.core.grid import Grid
from mpmcli.cracks.chain import Chain, divide
from mpmcli.cracks.crack_nodes import cross_nodes
from mpmcli.cracks.crossing import (
    BITS,
    OF,
    UNIT,
    allocate_segments,
    cell_of,
    crosses,
    find_segments,
    hash_segments,
    list_near,
    whole,
)
from mpmcli.cracks.points import AllPoints

few = st.tuples(st.integers(-4, 4), st.integers(-4, 4))
"""Points of a small lattice, most of them ties with each other."""


def grid(lower=(0.0, 0.0), cell=(1.0, 1.0)):
    lower, cell = np.array(lower), np.array(cell)
    return Grid(lower, lower + 20 * cell, cell, pad=2, width=3)


def segments_of(points, beyond=0.0, tips=(True, True), on=None):
    """Segments of one chain, as plain numbers: A, B (n, 2), whether A comes first."""
    on = on or grid()
    chain = Chain("c", 0, np.array(points, dtype=float).T, tips)
    points = AllPoints([chain], 1.0)
    found = allocate_segments(points.get())
    find_segments(points.get(), beyond, on.lower - on.pad * on.cell, on.cell, found)
    return found


def is_left(A, B, P):
    return (B[0] - A[0]) * (P[1] - A[1]) - (B[1] - A[1]) * (P[0] - A[0]) >= 0


def count_exactly(points, P, Q):
    """Crossings of the line of sight from P to Q by exact fractions and the rule for ties."""
    count = 0
    for A, B in itertools.pairwise(points):
        A, B = sorted([A, B])
        if is_left(A, B, P) != is_left(A, B, Q) and is_left(P, Q, A) != is_left(P, Q, B):
            count += 1
    return count


def count(found, P, Q, unit=UNIT):
    """Crossings of the line of sight from P to Q, as particles and faces count them."""
    px, py, x, y = (int(unit * v) for v in (*P, *Q))
    reach = max(abs(x - px), abs(y - py))
    table, near = hash_segments(found, 1 + (reach >> BITS)), np.zeros((len(found.whole), 7), dtype=np.int64)
    cell = cell_of(table, px >> BITS, py >> BITS)
    n = list_near(found, table, cell, px, py, x - px, y - py, 0, np.zeros((1, 1), dtype=bool), -1, near)
    return sum(bool(crosses(near, k, x - px, y - py)) for k in range(n))


@given(chain=st.lists(few, min_size=2, max_size=6), P=few, Q=few)
def test_crossings_are_exact(chain, P, Q):
    shift = np.array([5, 5])
    found = segments_of(np.array(chain) + shift)
    exact = [tuple(map(Fraction, point)) for point in chain]
    # the first node of the grid is at (-2, -2)
    assert count(found, np.array(P) + 7, np.array(Q) + 7) == count_exactly(exact, P, Q)


@given(chain=st.lists(few, min_size=2, max_size=6), P=few, Q=few)
def test_the_direction_of_a_chain_does_not_matter(chain, P, Q):
    chain = np.array(chain) + 5
    one, other = segments_of(chain), segments_of(chain[::-1])
    assert count(one, np.array(P) + 7, np.array(Q) + 7) == count(other, np.array(P) + 7, np.array(Q) + 7)
    np.testing.assert_array_equal(one.whole[:, :OF], other.whole[::-1, :OF])


@given(
    x=st.lists(st.integers(-9, 9), min_size=1, max_size=5, unique=True), P=few, Q=few, turned=st.booleans()
)
def test_a_straight_crack_has_two_sides(x, P, Q, turned):
    """Points above and below a long straight chain, however it is divided; those on it are on one side, always."""
    along = [(-20, 0), *((v, 0) for v in sorted(x)), (20, 0)]
    if turned:
        along, P, Q = [(b, a) for a, b in along], P[::-1], Q[::-1]
    found = segments_of(np.array(along) + 5)
    odd = count(found, np.array(P) + 7, np.array(Q) + 7) % 2 == 1
    height = (P[0], Q[0]) if turned else (P[1], Q[1])
    is_above = [v > 0 or (v == 0 and not turned) for v in height]
    if turned:  # left of the way upwards is where x is smaller, and what is on the line is left
        is_above = [v > 0 for v in height]
    assert odd == (is_above[0] != is_above[1])


@given(
    points=st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3)), min_size=2, max_size=5),
    P=st.tuples(st.floats(-3, 3), st.floats(-3, 3)),
    Q=few,
)
def test_random_places_are_exact_on_the_lattice_of_positions(points, P, Q):
    on = grid()
    origin = on.lower - on.pad * on.cell
    inside = [(5 + a, 5 + b) for a, b in points]
    exact = [
        tuple(Fraction(int(whole(v, o, 1.0))) for v, o in zip(point, origin, strict=True)) for point in inside
    ]
    found = segments_of(inside)
    p = [int(whole(5 + v, o, 1.0)) for v, o in zip(P, origin, strict=True)]
    q = [int(7 + v) << BITS for v in Q]
    assert count(found, p, q, unit=1) == count_exactly(
        exact, tuple(map(Fraction, p)), tuple(map(Fraction, q))
    )


@given(
    chain=st.lists(few, min_size=2, max_size=6), P=st.tuples(st.integers(0, 8), st.integers(0, 8)), first=few
)
def test_lines_of_sight_to_all_nodes_of_a_stencil_are_those_to_each(chain, P, first):
    found = segments_of(np.array(chain) + 5)
    px, py = (int(UNIT * (5 + 0.25 * v)) for v in P)
    x0, y0 = ((5 + first[0]) << BITS) - px, ((5 + first[1]) << BITS) - py
    table, cuts = hash_segments(found, 20), np.zeros((1, 1), dtype=bool)
    near, wide = np.zeros((2, len(found.whole), 7), dtype=np.int64)
    cell = cell_of(table, px >> BITS, py >> BITS)
    n = list_near(found, table, cell, px, py, x0, y0, 2, cuts, -1, near)
    most = list_near(found, table, cell, px, py, -20 << BITS, -20 << BITS, 40, cuts, -1, wide)
    times, crossed = np.zeros(9, dtype=np.int64), np.full(9, -1)
    cross_nodes(near, 0, n, x0, y0, range(3), times, crossed)
    for j in range(9):
        x, y = x0 + ((j % 3) << BITS), y0 + ((j // 3) << BITS)
        each = [int(wide[k, 0]) for k in range(most) if crosses(wide, k, x, y)]
        assert times[j] == len(each)
        if each:
            assert crossed[j] == each[min(1, len(each) - 1)]


def test_no_line_of_sight_slips_round_a_mouth():
    closed, open_ = (
        segments_of([(5, 5), (9, 5)], beyond=4.0, tips=tips) for tips in ((True, True), (False, True))
    )
    P, Q = (5.2, 6.5), (5.2, 7.5)  # before the start of the chain, at x = 3.2
    assert count(closed, P, Q) == 0
    assert count(open_, P, Q) == 1
    assert len(open_.whole) == 2
    assert count(open_, (11.2, 6.5), (11.2, 7.5)) == 0


def test_shifts_by_whole_cells_change_nothing():
    points = np.array([(3.1, 4.7), (6.3, 5.2), (9.9, 4.4)])
    for shift in ((0, 0), (7, 0), (3, -5)):
        on = grid(lower=np.array(shift) * 0.1, cell=(0.1, 0.1))
        found = segments_of(points * 0.1 + np.array(shift) * 0.1, on=on)
        base = segments_of(points * 0.1, on=grid(cell=(0.1, 0.1)))
        assert np.abs(found.whole[:, :OF] - base.whole[:, :OF]).max() <= 1


@given(
    points=st.lists(st.tuples(st.floats(0, 19), st.floats(0, 19)), min_size=2, max_size=6),
    reach=st.integers(0, 4),
)
def test_the_hash_lists_every_segment_near(points, reach):
    found = segments_of(points)
    table = hash_segments(found, reach)
    assert len(table.first) == 1 + np.count_nonzero(table.place >= 0)
    for s in range(len(found.whole)):
        ends = found.whole[s, :OF].reshape(2, 2)
        low, high = ends.min(axis=0) >> BITS, ends.max(axis=0) >> BITS
        for x in range(low[0] - reach, high[0] + reach + 1):
            for y in range(low[1] - reach, high[1] + reach + 1):
                cell = table.place[y - table.low[1], x - table.low[0]]
                mine = table.segment[table.first[cell] : table.first[cell + 1]]
                assert s in mine
                assert np.all(np.diff(mine) > 0)


@given(
    corners=st.lists(st.tuples(st.floats(-5, 5), st.floats(-5, 5)), min_size=2, max_size=5),
    longest=st.floats(0.1, 3),
)
def test_chains_are_divided_alike_from_either_end(corners, longest):
    corners = np.array(corners)
    one, other = divide(corners, longest), divide(corners[::-1], longest)
    np.testing.assert_array_equal(one, other[:, ::-1])
    assert np.hypot(*np.diff(one, axis=1)).max() <= longest * (1 + 1e-6)
    for corner in corners:
        assert np.any(np.all(one == corner[:, None], axis=0))
