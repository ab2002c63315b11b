#!/usr/bin/env bash
# Draws a set of pictures of embedded datasets, from the root of the repository.
#
#   tools/draw_pictures.sh demo|gallery|methods TOOL DIRECTORY
set -eu

ball='--camera-position 2.6,-3.4,1.9 --camera-focal-point 0,0,0 --camera-view-up 0,0,1 --camera-view-angle'
above='--camera-position 1.1,-4,11 --camera-focal-point 1.2,1.5,0.4 --camera-view-up 0,0,1 --camera-view-angle'
beside='--camera-position 1.1,-8,10 --camera-focal-point 1.1,1.55,0.4 --camera-view-up 0,0,1 --camera-parallel-scale'
atom='--camera-position -50,-80,30 --camera-focal-point 0,0,0 --camera-view-up 0,0,1 --camera-view-angle'
cloud='builtin:turbulence?size=64&type=float32&seed=5 --filter bspline --transfer-function inferno:peaks=6 --range 0.4,0.9 --unit-distance 0.006'

# Of docs/methods/classification.md: the options that its figures have in common.
green="--resolution 250,250 --transfer-function docs/methods/random-green.json $atom 17.5"
shells="--resolution 180,180 --transfer-function rainbow:peaks=4 --unit-distance 0.5 $atom 18"
holes="builtin:buckyball?cells=60000 --resolution 180,180 --transfer-function rainbow:peaks=4 --range 0.1,1.04 --unit-distance 0.004 $ball 23"
waves='--resolution 190,190 --transfer-function coolwarm:peaks=1 --range 0,1 --unit-distance 0.012 --camera-position -1.9,-3,4.6 --camera-focal-point 0,0,-0.05 --camera-view-up 0,0,1 --camera-view-angle 22'

# Of docs/methods/light.md: each on a mesh and on a grid.
mesh="builtin:buckyball?cells=500000 --resolution 300,300 $ball 23"
grid='builtin:marschner-lobb?size=96 --resolution 300,300 --filter bspline-interpolating'
side='--lights directional:-1,0.6,-1.2 --shadows'
white='0.85,0.8,0.7'

# Of docs/methods/slicing.md: planes across the view.
planes='builtin:turbulence?size=64&type=float32&seed=4 --resolution 300,300 --backend gl --source slices=view-3d'
few="$planes --slices 24 --transfer-function viridis:peaks=5 --range 0.5,0.9 --unit-distance 0.002"
fog="$planes --transfer-function inferno:ramp --range 0.45,0.75 --unit-distance 0.02 --lights directional:-1,0.6,-1.2*1.5 --gradient-threshold 1000"

# Of docs/methods/multidimensional.md: each on a mesh and on a grid.
duct="builtin:duct?cells=300000 --array pressure --resolution 300,300 $above 33"
bands='--transfer-function coolwarm:peaks=15 --range -1.2,0.548'
skins='--variables gradient --widget triangle:0.62,4:0.15,4:1,0.6,0.2:0.6 --widget triangle:0.35,4:0.15,4:0.2,0.5,1:0.3'
wave="builtin:hydrogen?size=64&type=float32 --resolution 300,300 $atom 19"

# Each line: set, picture, what `tetravox render` is given (or `tetravox histogram`, where that word comes first).
pictures="
demo     buckyball         builtin:buckyball?cells=2000000 --transfer-function inferno:peaks=4 --range 0.05,1.04 --unit-distance 0.016 $ball 23
demo     duct              builtin:duct?cells=300000 --array speed --transfer-function turbo:peaks=12 $above 31
demo     sphere            builtin:sphere?cells=300000 --transfer-function viridis:peaks=4 --unit-distance 0.07 $ball 27
demo     turbulence        $cloud
gallery  buckyball         builtin:buckyball?cells=2000000 --transfer-function inferno:peaks=4 --range 0.05,1.04 --unit-distance 0.016 $ball 23
gallery  duct-speed        builtin:duct?cells=300000 --array speed --transfer-function turbo:peaks=12 $above 33
gallery  sphere            builtin:sphere?cells=300000 --transfer-function viridis:peaks=4 --unit-distance 0.07 $ball 27
gallery  buckyball-ramp    builtin:buckyball?cells=2000000 --transfer-function plasma:ramp --range 0.15,1.04 --unit-distance 0.01 $ball 23
gallery  duct-pressure     builtin:duct?cells=300000 --array pressure --transfer-function coolwarm:peaks=15 --range -1.2,0.548 $beside 3.5
gallery  duct-volume       builtin:duct?cells=6000 --array volume --transfer-function viridis:constant=0.3 --log $above 34
gallery  turbulence        builtin:turbulence?size=64&type=float32&seed=4 --filter bspline --transfer-function viridis:peaks=5 --range 0.5,0.9 --unit-distance 0.005
gallery  hydrogen          builtin:hydrogen?size=64&type=float32 --transfer-function rainbow:peaks=6 --unit-distance 0.5 $atom 19
gallery  marschner-lobb    builtin:marschner-lobb?size=96 --filter bspline-interpolating --transfer-function plasma:peaks=1 --range 0,1 --unit-distance 0.006 --camera-elevation 20
gallery  hydrogen-wave     builtin:hydrogen?size=64&type=float32 --color-array wave --color-function coolwarm $atom 19
gallery  duct-arrays       builtin:duct?cells=300000 --array pressure --variables gradient,array:speed $above 33
gallery  turbulence-widgets builtin:turbulence?size=64&type=float32&seed=4 $skins
methods  green-pre         builtin:hydrogen $green --classification pre
methods  green-post        builtin:hydrogen $green --classification post --samples-per-voxel 1
methods  green-rate-1      builtin:hydrogen $green --samples-per-voxel 1
methods  green             builtin:hydrogen $green
methods  shells-post-0.5   builtin:hydrogen?size=32 $shells --classification post --samples-per-voxel 0.5
methods  shells-post-1     builtin:hydrogen?size=32 $shells --classification post --samples-per-voxel 1
methods  shells-post-2     builtin:hydrogen?size=32 $shells --classification post --samples-per-voxel 2
methods  shells-post-4     builtin:hydrogen?size=32 $shells --classification post --samples-per-voxel 4
methods  shells-rate-0.5   builtin:hydrogen?size=32 $shells --samples-per-voxel 0.5
methods  shells-rate-1     builtin:hydrogen?size=32 $shells --samples-per-voxel 1
methods  shells-rate-2     builtin:hydrogen?size=32 $shells --samples-per-voxel 2
methods  shells-rate-4     builtin:hydrogen?size=32 $shells --samples-per-voxel 4
methods  holes-post-1      $holes --integrator post --samples 1
methods  holes-post-2      $holes --integrator post --samples 2
methods  holes-post-4      $holes --integrator post --samples 4
methods  holes-none        $holes
methods  waves             builtin:marschner-lobb?size=321 $waves
methods  waves-nearest     builtin:marschner-lobb $waves --filter nearest
methods  waves-linear      builtin:marschner-lobb $waves
methods  waves-bspline     builtin:marschner-lobb $waves --filter bspline
methods  waves-interpolating builtin:marschner-lobb $waves --filter bspline-interpolating
methods  waves-catmull-rom builtin:marschner-lobb $waves --filter catmull-rom
methods  waves-mitchell    builtin:marschner-lobb $waves --filter mitchell
methods  waves-lanczos     builtin:marschner-lobb $waves --filter lanczos=4
methods  light-mesh        $mesh --transfer-function viridis:peaks=3 --range 0.1,1.04 --unit-distance 0.01 --shade
methods  unlit-mesh        $mesh --transfer-function viridis:peaks=3 --range 0.1,1.04 --unit-distance 0.01
methods  light-grid        $grid --transfer-function plasma:peaks=1 --range 0,1 --unit-distance 0.006 --shade
methods  unlit-grid        $grid --transfer-function plasma:peaks=1 --range 0,1 --unit-distance 0.006
methods  surface-mesh      $mesh --isosurface 0.45:$white --volume off
methods  surface-grid      $grid --isosurface 0.5:$white --volume off
methods  nested-mesh       $mesh --isosurface 0.15:0.3,0.5,0.9:0.35 --isosurface 0.7:0.9,0.5,0.2 --volume off
methods  nested-grid       builtin:hydrogen?size=64&type=float32 --resolution 300,300 $atom 19 --isosurface 0.05:0.3,0.5,0.9:0.35 --isosurface 0.3:0.9,0.5,0.2 --volume off
methods  shadow-mesh       $mesh --isosurface 0.45:$white --volume off $side volume
methods  shadow-grid       $grid --isosurface 0.5:$white --volume off $side volume
methods  exact-mesh        $mesh --isosurface 0.45:$white --volume off $side exact
methods  exact-grid        $grid --isosurface 0.5:$white --volume off $side exact
methods  open-mesh         $mesh --isosurface 0.45:$white --volume off --ambient-occlusion 64 --material 0.7,0.3,0.1,32
methods  open-grid         $grid --isosurface 0.5:$white --volume off --ambient-occlusion 64 --material 0.7,0.3,0.1,32
methods  studio-mesh       $mesh --isosurface 0.45:$white --volume off --environment builtin:studio --material 0.05,0.6,0.6,120
methods  studio-grid       builtin:hydrogen?size=64&type=float32 --resolution 300,300 $atom 19 --isosurface 0.08:$white --volume off --environment builtin:studio --material 0.05,0.6,0.6,120
methods  sky-mesh          $mesh --transfer-function viridis:peaks=3 --range 0.1,1.04 --unit-distance 0.004 --environment builtin:sky --material 0.1,0.9,0.4,40
methods  sky-grid          builtin:turbulence?size=64&type=float32&seed=4 --resolution 300,300 --filter bspline --transfer-function viridis:peaks=5 --range 0.5,0.9 --unit-distance 0.002 --environment builtin:sky --material 0.1,0.9,0.4,40
methods  clip-mesh         $mesh --isosurface 0.45 --transfer-function inferno:peaks=4 --range 0.05,1.04 --unit-distance 0.016 --clip-plane 0,0,0,-0.5,1,0.2
methods  clip-grid         builtin:turbulence?size=64&type=float32&seed=4 --resolution 300,300 --transfer-function viridis:peaks=5 --range 0.3,0.9 --unit-distance 0.003 --shade --clip-sphere outside:0.5,0.2,0.8,0.45
methods  weight-mesh       builtin:duct?cells=300000 --array speed --resolution 300,300 --transfer-function turbo:constant=0.5 $above 33 --opacity-weight scalar-difference --opacity-weight-scale 0.2
methods  weight-grid       builtin:turbulence?size=64&type=float32&seed=4 --resolution 300,300 --filter bspline --transfer-function viridis:constant=0.3 --opacity-weight gradient --opacity-weight-scale 0.1
methods  slices-post       $few --classification post
methods  slices-linear     $few --slabs linear
methods  slices-curved     $few
methods  slices-light      $fog
methods  slices-shadow     $fog --shadows half-angle
methods  slices-translucent $fog --shadows half-angle --translucency 0.8 --translucency-angle 30
methods  arrays-value-mesh $duct $bands
methods  arrays-gradient-mesh $duct --variables gradient
methods  arrays-color-mesh $duct $bands --color-array speed --color-function turbo
methods  arrays-three-mesh $duct --variables gradient,array:speed
methods  arrays-widgets-mesh builtin:buckyball?cells=500000 --resolution 300,300 $ball 27 --variables gradient --widget gaussian:0.3,3:0.05,1.5:1,0.6,0.2:0.3 --widget rectangle:0.8,0.7:0.3,0.7:0.3,0.6,1:0.3
methods  arrays-widgets-grid builtin:turbulence?size=64&type=float32&seed=4 --resolution 300,300 $skins
methods  arrays-value-grid $wave
methods  arrays-gradient-grid $wave --variables gradient
methods  arrays-color-grid $wave --color-array wave --color-function coolwarm
methods  arrays-three-grid $wave --variables gradient,array:wave
methods  arrays-histogram  histogram builtin:duct?cells=100000 --kind joint --array pressure --other-array speed
methods  boundaries-default builtin:buckyball?cells=500000 --resolution 320,320 $ball 23
methods  boundaries        builtin:buckyball?cells=500000 --resolution 320,320 --transfer-function auto:boundaries $ball 23
methods  boundaries-thick  builtin:buckyball?cells=500000 --resolution 320,320 --transfer-function auto:boundaries=1.5 $ball 23
methods  boundaries-histogram histogram builtin:buckyball?cells=500000 --kind gradient
"

[ $# -eq 3 ] || { echo "usage: tools/draw_pictures.sh demo|gallery|methods TOOL DIRECTORY" >&2; exit 2; }
wanted=$1 tool=$2 directory=$3
case $wanted in
  demo) size='--resolution 800,600' ;;
  gallery) size='--resolution 360,360' ;;
  *) size='' ;;  # figures have their own
esac

mkdir -p "$directory"
while read -r set name arguments; do
  [ "$set" = "$wanted" ] || continue
  case $arguments in
    histogram*) ;;
    *) arguments="render $arguments $size" ;;
  esac
  # shellcheck disable=SC2086  # the arguments of the table are words
  "$tool" $arguments -o "$directory/$name.png"
done <<<"$pictures"
