#!/usr/bin/env bash
# Installs the Debian packages that tetravox needs and this machine lacks.
#
#   tools/install_dependencies.sh [build] [test] [bench]      (build is always included)
#
# Says what it installs and what for. Nothing missing: one dpkg query and out.
# TETRAVOX_SKIP_DEPENDENCIES=1 leaves everything to you.
set -eu

# Each line: group, package, what it is for.
packages='
build cmake                 configures the build
build ninja-build           runs the build
build ccache                makes the second build quick
build g++                   the C++20 compiler
build pkg-config            finds Highway
build libhwy-dev            vector code (Highway)
build libtbb-dev            threads (oneTBB)
build nlohmann-json3-dev    scene files (JSON)
build libcli11-dev          command line
build libvtk9-dev           readers of mesh formats (VTK)
build libpugixml-dev        reader of PVD collections (XML)
build libpng-dev            PNG pictures
build libopenexr-dev        EXR pictures
build libtiff-dev           reader of TIFF stacks
build libepoxy-dev         OpenGL
build libegl-dev           OpenGL without a window (EGL)
build libegl1              the same, at run time
build libgl1-mesa-dri      OpenGL without graphics hardware (llvmpipe)
build zlib1g-dev            compressed NRRD, MetaImage and NIfTI
test  glslang-tools        check of the shaders
test  libgtest-dev          unit tests (GoogleTest)
test  libhdf5-dev           VTKHDF files made by the tests (HDF5)
test  clang-14              fuzz tests (libFuzzer)
test  libclang-rt-14-dev    fuzz tests (runtime)
test  clang-format-14       check of the formatting
test  clang-tidy-14         static analysis
test  python3               check of the include rules
bench python3               the driver of the benchmark
bench python3-numpy         errors against exact pictures
bench python3-vtk9          the peers: VTK ray casting and projected tetrahedra
bench xvfb                  a display for the peers
bench libgl1-mesa-dri       OpenGL in software for the peers
'

fail() { echo "install_dependencies: $*" >&2; exit 1; }

wanted=" build "
for group in "$@"; do
  case "$group" in
    build | test | bench) wanted="$wanted$group " ;;
    *) fail "no group '$group': choose from build, test, bench" ;;
  esac
done

[ "${TETRAVOX_SKIP_DEPENDENCIES:-}" = 1 ] && exit 0

declare -A reasons=()
needed=()
while read -r group package reason; do
  [ -n "$group" ] && [[ "$wanted" == *" $group "* ]] && [ -z "${reasons[$package]:-}" ] || continue
  reasons[$package]=$reason
  needed+=("$package")
done <<<"$packages"

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  fail "this is no Debian-like system: install the counterparts of ${needed[*]}," \
    "then set TETRAVOX_SKIP_DEPENDENCIES=1"
fi

# One query for all; packages it has never heard of make it fail, and are missing too.
installed=$(dpkg-query -W -f='${db:Status-Status} ${Package}\n' "${needed[@]}" 2>/dev/null || true)
missing=()
for package in "${needed[@]}"; do
  [[ $'\n'"$installed"$'\n' == *$'\n'"installed $package"$'\n'* ]] || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || fail "these packages are missing: ${missing[*]}. Run as root: apt-get install ${missing[*]}"
  as_root=(sudo)
fi

echo "install_dependencies: installing with apt"
for package in "${missing[@]}"; do printf '  %-22s %s\n' "$package" "${reasons[$package]}"; done
apt() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 "$@" </dev/null; }
apt update || fail "apt-get update failed: is there a network, and are the sources right?"
apt install -y --no-install-recommends "${missing[@]}" >/dev/null ||
  fail "apt-get could not install ${missing[*]}: see its message above"
