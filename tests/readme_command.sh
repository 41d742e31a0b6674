#!/bin/sh
# Prints README's first command (set up and run the main job) or its second one (set up and test):
#   tests/readme_command.sh 1|2
set -eu
readme=$(dirname "$0")/../README.md
grep '^\./setup\.sh' "$readme" | sed -n "${1:?1 or 2}p" | grep .
