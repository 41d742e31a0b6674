#!/bin/sh
# Sets AOS up in .venv, from nothing, without touching anything outside this folder.
#
#   ./setup.sh          what running a robot needs
#   ./setup.sh --dev    that, and what the tests need
#
# Run it as often as you like: what is already there is left alone. AOS_PYTHON names the Python to use,
# CXX the C++ compiler. As root on Debian or Ubuntu, missing system packages are installed with apt-get.
set -eu

cd "$(dirname "$0")"
VENV=.venv
LOCK=deploy/lock

say() { printf '%s\n' "setup: $*"; }

fail() {
    printf '%s\n' "setup: $1" >&2
    shift
    for line in "$@"; do printf '  %s\n' "$line" >&2; done
    exit 1
}

# --- Python ---

is_python() { # is_python COMMAND CONDITION: whether COMMAND runs and its version meets the condition
    "$1" -c "import sys; v = sys.version_info[:2]; sys.exit(not ($2))" >/dev/null 2>&1
}

has_venv() { "$1" -c 'import ensurepip, venv' >/dev/null 2>&1; }

has_headers() {
    "$1" -c 'import os, sysconfig; open(os.path.join(sysconfig.get_path("include"), "Python.h"))' >/dev/null 2>&1
}

places_of_3_11() {
    printf '%s\n' python3.11 python3 python
    for folder in "${PYENV_ROOT:-${HOME:-/}/.pyenv}/versions" "${HOME:-/}/.local/share/uv/python"; do
        for python in "$folder"/*3.11*/bin/python3.11; do
            if [ -x "$python" ]; then printf '%s\n' "$python"; fi
        done
    done
}

# pybullet has ready wheels up to CPython 3.11 and has to be compiled for anything newer.
find_python() {
    if [ -n "${AOS_PYTHON:-}" ]; then
        is_python "$AOS_PYTHON" 'v >= (3, 11)' || fail "AOS_PYTHON=$AOS_PYTHON is not a Python 3.11 or newer"
        PYTHON=$AOS_PYTHON
        return
    fi
    PYTHON=
    for candidate in $(places_of_3_11); do
        is_python "$candidate" 'v == (3, 11)' || continue
        if has_venv "$candidate"; then
            PYTHON=$candidate
            return
        fi
        PYTHON=${PYTHON:-$candidate}
    done
    for candidate in python3 python3.12 python3.13 python3.14; do
        if [ -z "$PYTHON" ] && is_python "$candidate" 'v >= (3, 12)'; then PYTHON=$candidate; fi
    done
    [ -n "$PYTHON" ] || fail "there is no Python 3.11 or newer here" \
        "Debian 12:  sudo apt-get install python3 python3-venv" \
        "elsewhere:  install Python 3.11, or name one with AOS_PYTHON=/path/to/python3.11"
}

apt_install() { # apt_install PACKAGE...: whether they could be installed
    [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1 || return 1
    say "installing with apt-get: $*"
    # Package lists may be absent or old on a fresh machine, so a failed first try is normal.
    DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "$@" >/dev/null 2>&1 ||
        { apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "$@" >/dev/null; }
}

version_of() { "$1" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null; }

has_usable_venv() {
    is_python "$VENV/bin/python" 'v >= (3, 11)' && "$VENV/bin/python" -m pip --version >/dev/null 2>&1 || return 1
    [ -z "${AOS_PYTHON:-}" ] || [ "$(version_of "$AOS_PYTHON")" = "$(version_of "$VENV/bin/python")" ]
}

make_venv() {
    if has_usable_venv; then return; fi
    find_python
    version=$(version_of "$PYTHON")
    if ! has_venv "$PYTHON"; then
        apt_install "python$version-venv" || fail "Python $version has no venv module" \
            "sudo apt-get install python$version-venv, then run this again"
    fi
    say "making $VENV with Python $version"
    rm -rf "$VENV"
    "$PYTHON" -m venv "$VENV"
}

# --- C++ ---

prepare_compiler() { "$VENV/bin/python" deploy/prepare_compiler.py; }

need_compiler() {
    say "trying the C++ compiler; the first time, the planning engine is compiled with it: some ten seconds"
    status=0
    compiler=$(prepare_compiler 2>"$VENV/compiler-messages") || status=$?
    if [ "$status" = 1 ] && [ -z "${CXX:-}" ]; then
        say "no C++ compiler here: installing the one in the ziglang package, 100 MB to load, 400 MB on disk"
        install "$LOCK/compiler.txt"
        say "building its C++ library and the engine: one to three minutes, once"
        status=0
        compiler=$(prepare_compiler 2>"$VENV/compiler-messages") || status=$?
    fi
    [ "$status" = 0 ] || fail "no C++ compiler works:" "$(cat "$VENV/compiler-messages")"
    say "C++ compiler: $compiler"
}

# --- packages ---

install() { # install REQUIREMENTS...: names, versions and hashes must all fit
    names=$*
    # Each file becomes an option.
    for file in "$@"; do
        shift
        set -- "$@" --requirement "$file"
    done
    "$VENV/bin/python" -m pip install --quiet --disable-pip-version-check --require-hashes \
        --no-build-isolation --use-pep517 "$@" ||
        fail "pip could not install $names" "If the network failed, run this again: it goes on where it stopped."
}

has_pybullet() { "$VENV/bin/python" -c 'import importlib.util as u, sys; sys.exit(u.find_spec("pybullet") is None)'; }

prepare_to_build_pybullet() { # prepare_to_build_pybullet REQUIREMENTS...
    python=$VENV/bin/python
    if ! command -v g++ >/dev/null 2>&1 || ! has_headers "$python"; then
        version=$(version_of "$python")
        if ! apt_install g++ "python$version-dev"; then
            # The next attempt may find another Python.
            rm -rf "$VENV"
            fail "pybullet has no ready package for Python $version; to build it here, a C++ compiler or Python's headers are missing" \
                "Do one of these, then run this again:" \
                "  sudo apt-get install g++ python$version-dev    (it is then built, about 8 minutes, once)" \
                "  install Python 3.11    (it is found on PATH, in pyenv's and in uv's folder, or named by AOS_PYTHON)"
        fi
    fi
    say "building pybullet for this Python, which has no ready package: about 8 minutes on two cores, once"
    # It looks for numpy when it is built, and hands pictures over slowly without it.
    awk '/^[a-z]/ { skip = /^pybullet==/ } !skip' "$@" >"$VENV/without-pybullet.txt"
    install "$VENV/without-pybullet.txt"
}

install_packages() { # install_packages REQUIREMENTS...
    say "installing $(cat "$@" | grep -c '^[a-z].*==') packages into $VENV: about 150 MB to load, 250 MB for development, a minute or two the first time"
    install "$LOCK/build.txt"
    if is_python "$VENV/bin/python" 'v >= (3, 12)' && ! has_pybullet; then prepare_to_build_pybullet "$@"; fi
    install "$@"
    "$VENV/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
}

stamp() { # stamp REQUIREMENTS...: changes with all that decides what is installed
    { pwd && cat pyproject.toml "$LOCK/build.txt" "$@" && "$VENV/bin/python" --version; } 2>/dev/null | cksum
}

main() {
    case "${1:-}" in
        '')
            done_file=$VENV/aos-runtime
            set -- "$LOCK/runtime.txt"
            ;;
        --dev)
            done_file=$VENV/aos-dev
            # The second pins only what the first does not. The third is Clang, which those use who have no g++.
            # A test compiles models with it.
            set -- "$LOCK/runtime.txt" "$LOCK/dev.txt" "$LOCK/compiler.txt"
            ;;
        *) fail "unknown option $1" "usage: ./setup.sh [--dev]" ;;
    esac
    began=$(date +%s)
    make_venv
    # The development set holds the other.
    if [ "$(stamp "$@")" = "$(cat "$done_file" 2>/dev/null)" ] ||
        [ "$(stamp "$LOCK/runtime.txt" "$LOCK/dev.txt" "$LOCK/compiler.txt")" = "$(cat "$VENV/aos-dev" 2>/dev/null)" ]; then
        say "the packages are up to date"
    else
        install_packages "$@"
        stamp "$@" >"$done_file"
    fi
    need_compiler
    say "ready after $(($(date +%s) - began)) s"
}

main "$@"
