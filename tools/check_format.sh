#!/usr/bin/env bash
# Checks the formatting of all C++ files; with --fix, formats them.
# The version of clang-format is fixed: others disagree in small things.
set -eu
cd "$(dirname "$0")/.."

command -v clang-format-14 >/dev/null || {
  echo "check_format: clang-format-14 is missing: run tools/install_dependencies.sh test" >&2
  exit 1
}
mode=(--dry-run --Werror)
[ "${1:-}" = --fix ] && mode=(-i)
find include src apps tests bench examples \( -name '*.h' -o -name '*.cpp' \) -print0 |
  xargs -0 -r -n 40 -P "$(nproc)" clang-format-14 "${mode[@]}" ||
  { echo "check_format: run 'make format'" >&2; exit 1; }
