#!/bin/sh
# Every check of the project, the quick ones first, the tests last. Exit code 0 means that all of them passed.
#
#   tests/check.sh             all of them
#   tests/check.sh --quick     without whole systems (tests/process), simulated worlds, robots that speak ROS, and kills
#   tests/check.sh ARGUMENTS   arguments go to pytest
set -u
cd "$(dirname "$0")/.." || exit 2

BIN=.venv/bin
failed=

step() { # step NAME COMMAND...: runs a check, remembers whether it failed
    name=$1
    shift
    printf '== %s: %s\n' "$name" "$*"
    "$@" || failed="$failed $name"
}

if [ ! -x "$BIN/pytest" ]; then
    echo "check: the test tools are not installed; run ./setup.sh --dev" >&2
    exit 2
fi

# Tests start hundreds of processes. Each would compile the same modules anew.
unset PYTHONDONTWRITEBYTECODE

# The first tests wait for this program. Checks of style leave a processor to it.
[ $# -gt 0 ] || "$BIN/python" tests/engine_checks.py &

step style "$BIN/ruff" check
step form "$BIN/ruff" format --check
step types "$BIN/mypy"
step layers "$BIN/lint-imports"
step reference "$BIN/python" docs/write_reference.py --check
if command -v shellcheck >/dev/null 2>&1; then
    step shell shellcheck setup.sh tests/*.sh .ci/run
fi

if [ -n "$failed" ]; then
    echo "check: failed before the tests:$failed" >&2
    exit 1
fi

# One process more than there are cores: tests also wait for each other's processes. Each takes whole files, the
# longest first (tests/conftest.py), since tests of one file share what they compile.
processes=$(($(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2) + 1))
[ "$processes" -le 5 ] || processes=5
spread="--numprocesses $processes --dist loadfile --no-loadscope-reorder"
# shellcheck disable=SC2086 # The options are words.
case ${1:-} in
    '') set -- $spread ;;
    --quick)
        shift
        set -- $spread -m "not physics and not slow" tests/unit tests/golden tests/contract "$@"
        ;;
esac
printf '== tests: %s\n' "$BIN/pytest $*"
exec "$BIN/pytest" "$@"
