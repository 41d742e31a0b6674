"""What document code may take from the C++ library: headers by name, and what it must leave alone."""

from __future__ import annotations

import re

__all__ = ["headers_for", "unrepeatable_names"]

_HEADERS = {
    "algorithm": (
        "adjacent_find all_of any_of binary_search clamp copy copy_if count count_if equal fill find find_if "
        "for_each generate is_sorted lower_bound max_element min_element minmax minmax_element none_of "
        "nth_element partial_sort partition remove remove_if replace replace_if reverse rotate search sort "
        "stable_sort transform unique upper_bound"
    ),
    "bitset": "bitset",
    "cassert": "assert",
    "climits": "INT_MAX INT_MIN",
    "cstdio": "printf puts",
    "cstdlib": "abs atof atoi labs strtod strtol",
    "deque": "deque",
    "functional": "cref function greater less minus plus ref",
    "iomanip": "setprecision setw",
    "iostream": "cerr clog cout endl",
    "limits": "numeric_limits",
    "list": "list",
    "map": "map multimap",
    "numeric": "accumulate inner_product iota partial_sum reduce",
    "optional": "nullopt optional",
    "queue": "priority_queue queue",
    "set": "multiset set",
    "sstream": "istringstream ostringstream stringstream",
    "stack": "stack",
    "unordered_map": "unordered_map",
    "unordered_set": "unordered_set",
}
_HEADER_OF = {name: header for header, names in _HEADERS.items() for name in names.split()}

_UNREPEATABLE = frozenset({
    "chrono", "clock", "clock_gettime", "default_random_engine", "drand48", "getrandom", "gettimeofday",
    "mt19937", "mt19937_64", "rand", "rand_r", "random", "random_device", "random_shuffle", "srand",
    "srandom", "time", "uniform_int_distribution", "uniform_real_distribution",
})  # fmt: skip
_CHANGING_STATIC = re.compile(r"\b(?:static|thread_local)\b(?!\s+(?:const|constexpr)\b)(?!_)")


def headers_for(names: frozenset[str]) -> tuple[str, ...]:
    """The standard headers, sorted, that declare any of these identifiers."""
    return tuple(sorted({_HEADER_OF[name] for name in names if name in _HEADER_OF}))


def unrepeatable_names(called: frozenset[str], code: str) -> list[str]:
    """What in `code` (without comments and texts) gives another result when it runs again."""
    found = sorted(called & _UNREPEATABLE)
    return [*found, *(match[0] for match in _CHANGING_STATIC.finditer(code))]
