#!/bin/sh
# Every check of the project, the quick ones first, the tests last. Arguments go to pytest.
# Exit code 0 means that all of them passed.
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

# Each process takes whole files: tests of one share what they compile.
if [ $# = 0 ]; then
    set -- --numprocesses auto --maxprocesses 4 --dist loadfile
fi
printf '== tests: %s\n' "$BIN/pytest $*"
exec "$BIN/pytest" "$@"
