"""The parts of the C++ library that document code may take: headers by name, and what it must leave alone."""

import re

_HEADERS = {
    "algorithm": (
        "adjacent_find all_of any_of binary_search clamp copy copy_if count count_if equal fill find find_if "
        "find_if_not for_each generate includes is_permutation is_sorted lower_bound max_element merge "
        "min_element minmax minmax_element mismatch next_permutation none_of nth_element partial_sort "
        "partition prev_permutation remove remove_if replace replace_if reverse rotate search "
        "set_difference set_intersection set_union sort stable_sort transform unique upper_bound "
        "copy_backward copy_n equal_range fill_n find_end find_first_of generate_n is_heap is_partitioned "
        "iter_swap lexicographical_compare make_heap max min move_backward partial_sort_copy "
        "partition_copy partition_point pop_heap push_heap ranges remove_copy remove_copy_if replace_copy "
        "replace_copy_if reverse_copy rotate_copy search_n set_symmetric_difference sort_heap "
        "stable_partition swap_ranges unique_copy"
    ),
    "any": "any any_cast",
    "aos/model/map_views.hpp": "keys values",
    "bit": (
        "bit_cast bit_ceil bit_floor bit_width countl_zero countr_one countr_zero has_single_bit popcount "
        "rotl rotr"
    ),
    "bitset": "bitset",
    "cassert": "assert",
    "cctype": "isalnum isalpha isdigit islower isspace isupper tolower toupper",
    "cfloat": "DBL_EPSILON DBL_MAX DBL_MIN FLT_EPSILON FLT_MAX FLT_MIN",
    "charconv": "from_chars to_chars",
    "chrono": "chrono chrono_literals",
    "climits": "CHAR_BIT INT_MAX INT_MIN LLONG_MAX LLONG_MIN LONG_MAX LONG_MIN UINT_MAX",
    "complex": "complex",
    "cstdio": "fprintf printf putchar puts snprintf sprintf",
    "cstdlib": "abs atof atoi atol div labs ldiv qsort strtod strtol strtoul",
    "cstring": (
        "memcmp memcpy memmove memset strcat strchr strcmp strcpy strlen strncmp strncpy strrchr strstr"
    ),
    "deque": "deque",
    "forward_list": "forward_list",
    "functional": (
        "bind cref divides equal_to function greater greater_equal hash invoke less less_equal logical_and "
        "logical_not logical_or mem_fn minus modulus multiplies negate not_equal_to not_fn plus ref"
    ),
    "iomanip": "quoted setfill setprecision setw",
    "iostream": "cerr clog cout endl",
    "iterator": "advance back_inserter distance front_inserter inserter make_move_iterator",
    "limits": "numeric_limits",
    "list": "list",
    "map": "map multimap",
    "memory": "make_shared make_unique shared_ptr unique_ptr",
    "numbers": "numbers",
    "numeric": (
        "accumulate adjacent_difference exclusive_scan gcd inclusive_scan inner_product iota lcm midpoint "
        "partial_sum reduce transform_reduce"
    ),
    "optional": "nullopt optional",
    "queue": "priority_queue queue",
    "ranges": "views",
    "set": "multiset set",
    "span": "span",
    "sstream": "istringstream ostringstream stringstream",
    "stack": "stack",
    "stdexcept": (
        "domain_error invalid_argument length_error logic_error out_of_range overflow_error range_error "
        "runtime_error"
    ),
    "string_view": "string_view",
    "unordered_map": "unordered_map",
    "unordered_set": "unordered_multiset unordered_set",
    "valarray": "valarray",
    "variant": "holds_alternative monostate variant visit",
}
_HEADER_OF = {name: header for header, names in _HEADERS.items() for name in names.split()}

_DRAWS = {
    "bernoulli_distribution": "`AOS.Bernoulli(p)`",
    "binomial_distribution": "`AOS.Bernoulli(p)` in a loop, and count",
    "discrete_distribution": "`AOSUtils::SampleDiscrete(std::vector<double>{...})`, which gives an index",
    "normal_distribution": "`AOS.SampleNormal(mean, deviation)`",
    "uniform_int_distribution": "`low + AOSUtils::SampleDiscrete(std::vector<double>(n, 1.0 / n))`",
    "uniform_real_distribution": "`AOS.SampleUniform(low, high)`",
}
"""Draws of AOS in the place of distributions."""
_GENERATORS = frozenset({
    "default_random_engine", "knuth_b", "minstd_rand", "minstd_rand0", "mt19937", "mt19937_64",
    "random_device", "ranlux24", "ranlux24_base", "ranlux48", "ranlux48_base",
})  # fmt: skip
_UNREPEATABLE = _GENERATORS | frozenset(_DRAWS) | frozenset({
    "cauchy_distribution", "chi_squared_distribution", "clock", "clock_gettime", "drand48",
    "exponential_distribution", "extreme_value_distribution", "fisher_f_distribution", "gamma_distribution",
    "geometric_distribution", "getrandom", "gettimeofday", "lognormal_distribution",
    "negative_binomial_distribution", "piecewise_constant_distribution", "piecewise_linear_distribution",
    "poisson_distribution", "rand", "rand_r", "random", "random_shuffle", "srand", "srandom",
    "student_t_distribution", "time", "weibull_distribution",
})  # fmt: skip
_CLOCK = re.compile(r"(?<=chrono::)\w+_clock\b|\b(?:steady|system|high_resolution)_clock(?=::)")
_CHANGING_STATIC = re.compile(
    r"(?<!\bconst )(?<!\bconstexpr )\b(?:static|thread_local)\b"
    r"(?!\s+(?:[\w:<>,]+\s+){0,3}?(?:const|constexpr)\b)"  # a constant
    r"(?!\s[\w:<>,*&\s]+\([^()]*\)\s*(?:const\s*|noexcept\s*)*(?:->[^;{}]*)?\{)"  # a function
)


def headers_for(names: frozenset[str]) -> tuple[str, ...]:
    """The standard headers, sorted, that declare any of these identifiers."""
    return tuple(sorted({_HEADER_OF[name] for name in names if name in _HEADER_OF}))


def unrepeatable_names(called: frozenset[str], code: str) -> list[str]:
    """Returns what in `code` (without comments and texts) gives another result when it runs again."""
    found = sorted(called & _UNREPEATABLE)
    found += sorted(set(_CLOCK.findall(code)))
    return [*found, *(match[0] for match in _CHANGING_STATIC.finditer(code))]


def instead_of_unrepeatable(name: str) -> str:
    """Returns what to write in the place of a name that `unrepeatable_names` gives, as a hint."""
    if name in _GENERATORS:
        return "Leave it out: AOS.Bernoulli and its like need no generator"
    if (draw := _DRAWS.get(name)) is not None:
        return f"Write {draw}"
    return "Draw with AOS.Bernoulli and its like; keep what changes in the state"
