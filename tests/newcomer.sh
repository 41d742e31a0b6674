#!/usr/bin/env bash
# Does what README says in the place of somebody who has just arrived: a fresh clone of the last commit, an
# empty home, no C++ compiler on PATH. Runs README's two commands as they are written there.
#
#   tests/newcomer.sh [--with-compiler] [--keep]
#
# Loads about 250 MB from the package index and takes up to a quarter of an hour. --with-compiler leaves the
# machine's compiler on PATH; --keep leaves the clone where it is. Settings of pip and proxies in the
# environment are handed on, since an empty home has none.
set -euo pipefail

checkout=$(cd "$(dirname "$0")/.." && pwd)
with_compiler=false
keep=false
for option in "$@"; do
    case $option in
        --with-compiler) with_compiler=true ;;
        --keep) keep=true ;;
        *) echo "usage: tests/newcomer.sh [--with-compiler] [--keep]" >&2 && exit 2 ;;
    esac
done

# What the two commands may expect of a bare Debian. A tool that is missing in this list is a dependency that
# README does not tell of.
tools=(
    awk bash basename cat chmod cksum cp cut date dirname env expr false find getconf git grep head hostname id
    kill ln ls mkdir mktemp mv ps pwd readlink realpath rm rmdir sed setsid sh sleep sort stat tail tar tee test
    timeout touch tr true uname uniq wc which xargs
)
compilers=(g++ as ld)

scratch=$(mktemp -d "${TMPDIR:-/tmp}/aos-newcomer.XXXXXX")
clean() { if $keep; then echo "newcomer: left in $scratch"; else rm -rf "$scratch"; fi; }
trap clean EXIT
mkdir "$scratch/home" "$scratch/tools" "$scratch/tmp"

if $with_compiler; then tools+=("${compilers[@]}"); fi
for tool in "${tools[@]}"; do
    if path=$(type -P "$tool"); then ln -s "$(realpath "$path")" "$scratch/tools/$tool"; fi
done
python=$(python3.11 -c 'import sys; print(sys.executable)' 2>/dev/null || python3 -c 'import sys; print(sys.executable)')
# A link would make the interpreter look for its library beside the link.
printf '#!/bin/sh\nexec "%s" "$@"\n' "$python" >"$scratch/tools/python3"
chmod +x "$scratch/tools/python3"

mapfile -t handed_on < <(env | grep -E '^(PIP_|SSL_CERT_|REQUESTS_CA_BUNDLE=|(https?|no)_proxy=|(HTTPS?|NO)_PROXY=)' || true)

in_clone() { # in_clone COMMAND: runs a line of README
    (cd "$scratch/aos" && timeout 1500 env -i "${handed_on[@]}" HOME="$scratch/home" PATH="$scratch/tools" \
        TMPDIR="$scratch/tmp" LANG=C.UTF-8 bash -c "$1" </dev/null)
}

processes() { # the processes that still run from the clone
    for process in /proc/[0-9]*; do
        if tr '\0' ' ' 2>/dev/null <"$process/cmdline" | grep -F -- "$scratch/aos"; then :; fi
    done
}

git clone --quiet "$checkout" "$scratch/aos"
echo "newcomer: $(git -C "$checkout" log -1 --format='%h %s'), $("$python" --version)"
if ! $with_compiler && in_clone 'command -v g++ || command -v clang++ || command -v c++'; then
    echo "newcomer: a compiler is still on PATH" >&2
    exit 2
fi

took=()
for number in 1 2; do
    command=$("$scratch/aos/tests/readme_command.sh" "$number")
    echo "newcomer: \$ $command"
    began=$(date +%s)
    status=0
    in_clone "$command" || status=$?
    took+=("$(($(date +%s) - began))")
    if [ "$status" != 0 ]; then
        echo "newcomer: command $number ended with $status after ${took[-1]} s" >&2
        exit 1
    fi
    left=$(processes)
    if [ -n "$left" ]; then
        printf 'newcomer: still running after command %s:\n%s\n' "$number" "$left" >&2
        exit 1
    fi
done

size() { du -sm "$1" | cut -f1; }
echo "newcomer: green; main job after ${took[0]} s, tests after ${took[1]} s;" \
    "$(size "$scratch/aos") MB in the clone, $(size "$scratch/home") MB in the home"
