#!/bin/sh
# Takes the pictures that the golden tests draw now as the approved ones (tests/golden/*.png).
# Usage: tools/approve_golden.sh [build directory, default build/release]. Look at the pictures before committing them.
set -eu
cd "$(dirname "$0")/.."
program="${1:-build/release}/bin/test_golden"
if [ ! -x "$program" ]; then
  echo "approve_golden.sh: there is no $program: build it first (make test, or name another build directory)" >&2
  exit 1
fi
TETRAVOX_APPROVE_GOLDEN=1 "$program" --gtest_brief=1
git status --short tests/golden
