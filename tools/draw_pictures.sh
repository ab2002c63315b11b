#!/usr/bin/env bash
# Draws a set of pictures of embedded datasets.
#
#   tools/draw_pictures.sh demo|gallery TOOL DIRECTORY
set -eu

# Each line: set, picture, what `tetravox render` is given.
pictures='
demo     buckyball         builtin:buckyball --transfer-function inferno:linear --resolution 800,600
demo     duct              builtin:duct      --transfer-function coolwarm:ramp --resolution 800,600
demo     sphere            builtin:sphere    --transfer-function viridis:peaks=6 --resolution 800,600
gallery  buckyball         builtin:buckyball --transfer-function inferno:linear
gallery  duct              builtin:duct      --transfer-function coolwarm:ramp
gallery  sphere            builtin:sphere    --transfer-function viridis:linear
gallery  buckyball-random  builtin:buckyball --transfer-function random=7
gallery  duct-peaks        builtin:duct      --transfer-function turbo:peaks=8
gallery  sphere-peaks      builtin:sphere    --transfer-function viridis:peaks=6
'

[ $# -eq 3 ] || { echo "usage: tools/draw_pictures.sh demo|gallery TOOL DIRECTORY" >&2; exit 2; }
wanted=$1 tool=$2 directory=$3
gallery_resolution=400,400

mkdir -p "$directory"
while read -r set name arguments; do
  [ "$set" = "$wanted" ] || continue
  [ "$set" = gallery ] && arguments="$arguments --resolution $gallery_resolution"
  # shellcheck disable=SC2086  # the arguments of the table are words
  "$tool" render $arguments -o "$directory/$name.png"
  echo "$directory/$name.png"
done <<<"$pictures"
