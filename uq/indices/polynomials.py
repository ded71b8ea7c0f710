"""Polynomials in correlated normal scores (Wick products), with analytical Shapley values."""

from collections import defaultdict
from collections.abc import Sequence
from functools import lru_cache
from itertools import combinations, combinations_with_replacement, permutations
from math import comb, factorial, prod, sqrt

import numpy as np

from uq.contract import Floats

DEGREE = 3
"""Largest total degree of the products."""

MOST_TOGETHER = 12
"""Largest number of mutually correlated inputs, limited by the number of their subsets."""

Term = tuple[int, ...]
"""Sorted indices of the scores in a product; a power repeats its index."""


def terms_of(places: Sequence[int], matrix: Floats, most: float) -> tuple[Term, ...]:
    """Return the products of scores up to the highest degree with at most `most` products.

    Parameters
    ----------
    places : sequence of int
    matrix : ndarray, shape (d, d)
        Correlation matrix of all scores.
    most : float

    Returns
    -------
    tuple of tuple of int
        Products that depend on more than `MOST_TOGETHER` inputs are excluded. The inputs of a
        product are its factors and all inputs correlated with them.
    """
    terms: tuple[Term, ...] = ()
    for degree in range(1, DEGREE + 1):
        if comb(len(places) + degree, degree) - 1 > most:
            break
        more = combinations_with_replacement(places, degree)
        groups = _groups(matrix)
        terms += tuple(term for term in more if len(_inputs_of(term, groups)) <= MOST_TOGETHER)
    return terms


def products(z: Floats, terms: Sequence[Term], matrix: Floats) -> Floats:
    """Return Wick products of normal scores.

    Parameters
    ----------
    z : ndarray, shape (..., d)
    terms : sequence of tuple of int
    matrix : ndarray, shape (d, d)

    Returns
    -------
    ndarray, shape (..., terms)
        Products of different degree are uncorrelated, and have mean zero. For independent scores
        they are products of Hermite polynomials. They are scaled to a variance of the order of 1.
    """
    cache: dict[Term, Floats] = {(): np.ones(z.shape[:-1])}

    def product(term: Term) -> Floats:
        if term not in cache:
            first, rest = term[0], term[1:]
            value = z[..., first] * product(rest)
            for i, other in enumerate(rest):
                if matrix[first, other]:
                    value = value - matrix[first, other] * product(rest[:i] + rest[i + 1 :])
            cache[term] = value
        return cache[term]

    values = np.empty((*z.shape[:-1], len(terms)))
    for i, term in enumerate(terms):
        values[..., i] = product(term) * _scale(term)
    return values


def shapley_values(weights: Floats, terms: Sequence[Term], matrix: Floats) -> Floats:
    """Return the Shapley values of the variance of a polynomial.

    Parameters
    ----------
    weights : ndarray, shape (terms, e)
        Coefficients of `products`; the variances of the elements are summed.
    terms : sequence of tuple of int
    matrix : ndarray, shape (d, d)

    Returns
    -------
    ndarray, shape (d,)

    Notes
    -----
    The conditional mean of a Wick product given a set of scores is the Wick product of the
    conditional means of its factors. The covariance of two products of degree n is the sum, over
    all pairings of their factors, of the products of the covariances of the pairs [1]_.

    References
    ----------
    .. [1] S. Janson, "Gaussian Hilbert Spaces", Cambridge University Press (1997), theorems 3.9
       and 4.9.
    """
    effects = np.zeros(len(matrix))
    for indices, inputs, matrices in _forms(tuple(terms), matrix.tobytes()):
        form_weights = weights[indices]
        effects[inputs] += np.einsum("itu,tu->i", matrices, form_weights @ form_weights.T)
    return effects


@lru_cache(maxsize=8)
def _forms(terms: tuple[Term, ...], matrix: bytes) -> list[tuple[list[int], list[int], Floats]]:
    """Return the Shapley values of a sum of products, as quadratic forms in their weights.

    Returns
    -------
    list of (terms, inputs, matrices)
        One form for each group of products with the same inputs, since all others are uncorrelated:
        the indices of the products and of the inputs, and a matrix for each input, shape (inputs,
        terms, terms).
    """
    flat = np.frombuffer(matrix)
    square = flat.reshape(round(sqrt(len(flat))), -1)
    groups, together = _groups(square), defaultdict[tuple[int, ...], list[int]](list)
    for i, term in enumerate(terms):
        together[_inputs_of(term, groups)].append(i)
    return [
        (indices, list(inputs), _matrices([terms[i] for i in indices], inputs, square))
        for inputs, indices in together.items()
    ]


def _matrices(terms: list[Term], inputs: tuple[int, ...], matrix: Floats) -> Floats:
    """Return the Shapley form of a group of products, from all subsets of inputs (Shapley 1953)."""
    d = len(inputs)
    matrices = np.zeros((d, len(terms), len(terms)))
    for size in range(1, d + 1):
        for subset in combinations(range(d), size):
            explained = _explained(terms, [inputs[i] for i in subset], matrix)
            share = np.full(d, -1 / (d - size) / comb(d, size) if size < d else 0.0)
            share[list(subset)] = 1 / size / comb(d, size)
            matrices += share[:, None, None] * explained
    return matrices


def _explained(terms: list[Term], given: list[int], matrix: Floats) -> Floats:
    """Return the covariances of the conditional means of products, given scores."""
    shared = matrix[:, given] @ np.linalg.solve(matrix[np.ix_(given, given)], matrix[given])
    scale = np.array([_scale(term) for term in terms])
    covariances = np.zeros((len(terms), len(terms)))
    degrees = np.array([len(term) for term in terms])
    for degree in set(degrees.tolist()):
        rows = np.flatnonzero(degrees == degree)
        places = np.array([terms[i] for i in rows])
        pairs = shared[places[:, None, :, None], places[None, :, None, :]]
        ways = (
            prod(pairs[..., i, j] for i, j in enumerate(order))
            for order in permutations(range(degree))
        )
        covariances[np.ix_(rows, rows)] = sum(ways)
    return np.asarray(covariances * scale * scale[:, None])


def _scale(term: Term) -> float:
    """Return the reciprocal of the standard deviation of a product of independent scores."""
    return 1 / sqrt(prod(factorial(term.count(place)) for place in set(term)))


def _groups(matrix: Floats) -> Floats:
    """Return the group of each input: inputs correlated directly or indirectly share a group."""
    from scipy.sparse.csgraph import connected_components

    return np.asarray(connected_components(matrix != 0, directed=False)[1])


def _inputs_of(term: Term, groups: Floats) -> tuple[int, ...]:
    """Return the inputs on which a product, or its conditional mean given others, depends."""
    return tuple(np.flatnonzero(np.isin(groups, groups[list(term)])).tolist())
