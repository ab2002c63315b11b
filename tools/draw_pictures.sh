#!/usr/bin/env bash
# Draws a set of pictures of embedded datasets.
#
#   tools/draw_pictures.sh demo|gallery TOOL DIRECTORY
set -eu

ball='--camera-position 2.6,-3.4,1.9 --camera-focal-point 0,0,0 --camera-view-up 0,0,1 --camera-view-angle'
above='--camera-position 1.1,-4,11 --camera-focal-point 1.2,1.5,0.4 --camera-view-up 0,0,1 --camera-view-angle'
beside='--camera-position 1.1,-8,10 --camera-focal-point 1.1,1.55,0.4 --camera-view-up 0,0,1 --camera-parallel-scale'

# Each line: set, picture, what `tetravox render` is given.
pictures="
demo     buckyball         builtin:buckyball?cells=2000000 --transfer-function inferno:peaks=4 --range 0.05,1.04 --unit-distance 0.016 $ball 23
demo     duct              builtin:duct?cells=300000 --array speed --transfer-function turbo:peaks=12 $above 31
demo     sphere            builtin:sphere?cells=300000 --transfer-function viridis:peaks=4 --unit-distance 0.07 $ball 27
gallery  buckyball         builtin:buckyball?cells=2000000 --transfer-function inferno:peaks=4 --range 0.05,1.04 --unit-distance 0.016 $ball 23
gallery  duct-speed        builtin:duct?cells=300000 --array speed --transfer-function turbo:peaks=12 $above 33
gallery  sphere            builtin:sphere?cells=300000 --transfer-function viridis:peaks=4 --unit-distance 0.07 $ball 27
gallery  buckyball-ramp    builtin:buckyball?cells=2000000 --transfer-function plasma:ramp --range 0.15,1.04 --unit-distance 0.01 $ball 23
gallery  duct-pressure     builtin:duct?cells=300000 --array pressure --transfer-function coolwarm:peaks=15 --range -1.2,0.548 $beside 3.5
gallery  duct-volume       builtin:duct?cells=6000 --array volume --transfer-function viridis:constant=0.3 --log $above 34
"

[ $# -eq 3 ] || { echo "usage: tools/draw_pictures.sh demo|gallery TOOL DIRECTORY" >&2; exit 2; }
wanted=$1 tool=$2 directory=$3
case $wanted in demo) resolution=800,600 ;; *) resolution=360,360 ;; esac

mkdir -p "$directory"
while read -r set name arguments; do
  [ "$set" = "$wanted" ] || continue
  # shellcheck disable=SC2086  # the arguments of the table are words
  "$tool" render $arguments --resolution "$resolution" -o "$directory/$name.png"
done <<<"$pictures"
