"""The parts of the C++ library that document code may take: headers by name, and what it must leave alone."""

from __future__ import annotations

import re

__all__ = ["headers_for", "unrepeatable_names"]

_HEADERS = {
    "algorithm": (
        "adjacent_find all_of any_of binary_search clamp copy copy_if count count_if equal fill find find_if "
        "find_if_not for_each generate includes is_permutation is_sorted lower_bound max_element merge "
        "min_element minmax minmax_element mismatch next_permutation none_of nth_element partial_sort "
        "partition prev_permutation remove remove_if replace replace_if reverse rotate search "
        "set_difference set_intersection set_union sort stable_sort transform unique upper_bound"
    ),
    "bitset": "bitset",
    "cassert": "assert",
    "cctype": "isalnum isalpha isdigit islower isspace isupper tolower toupper",
    "cfloat": "DBL_EPSILON DBL_MAX DBL_MIN FLT_EPSILON FLT_MAX FLT_MIN",
    "climits": "CHAR_BIT INT_MAX INT_MIN LLONG_MAX LLONG_MIN LONG_MAX LONG_MIN UINT_MAX",
    "complex": "complex",
    "cstdio": "fprintf printf putchar puts snprintf sprintf",
    "cstdlib": "abs atof atoi labs strtod strtol",
    "cstring": "memcmp memcpy memset strcmp strcpy strlen strncmp",
    "deque": "deque",
    "functional": "bind cref function greater greater_equal less less_equal minus multiplies plus ref",
    "iomanip": "setprecision setw",
    "iostream": "cerr clog cout endl",
    "iterator": "back_inserter front_inserter inserter",
    "limits": "numeric_limits",
    "list": "list",
    "map": "map multimap",
    "memory": "make_shared make_unique shared_ptr unique_ptr",
    "numeric": "accumulate adjacent_difference gcd inner_product iota lcm midpoint partial_sum reduce",
    "optional": "nullopt optional",
    "queue": "priority_queue queue",
    "set": "multiset set",
    "sstream": "istringstream ostringstream stringstream",
    "stack": "stack",
    "stdexcept": "domain_error invalid_argument logic_error out_of_range range_error runtime_error",
    "string_view": "string_view",
    "unordered_map": "unordered_map",
    "unordered_set": "unordered_multiset unordered_set",
    "variant": "holds_alternative monostate variant visit",
}
_HEADER_OF = {name: header for header, names in _HEADERS.items() for name in names.split()}

_UNREPEATABLE = frozenset({
    "chrono", "clock", "clock_gettime", "default_random_engine", "drand48", "getrandom", "gettimeofday",
    "mt19937", "mt19937_64", "rand", "rand_r", "random", "random_device", "random_shuffle", "srand",
    "srandom", "time", "uniform_int_distribution", "uniform_real_distribution",
})  # fmt: skip
_CHANGING_STATIC = re.compile(
    r"(?<!\bconst )(?<!\bconstexpr )\b(?:static|thread_local)\b(?!\s+(?:const|constexpr)\b)(?!_)"
)


def headers_for(names: frozenset[str]) -> tuple[str, ...]:
    """The standard headers, sorted, that declare any of these identifiers."""
    return tuple(sorted({_HEADER_OF[name] for name in names if name in _HEADER_OF}))


def unrepeatable_names(called: frozenset[str], code: str) -> list[str]:
    """Returns what in `code` (without comments and texts) gives another result when it runs again."""
    found = sorted(called & _UNREPEATABLE)
    return [*found, *(match[0] for match in _CHANGING_STATIC.finditer(code))]
