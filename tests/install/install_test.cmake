# Installs a build into an empty prefix, then configures, builds and runs programs against that prefix alone.
#
#   cmake -DBUILD_DIR=.. -DSOURCE_DIR=.. -DWORK_DIR=.. [-DWITH_IO=ON] -P install_test.cmake

cmake_minimum_required(VERSION 3.25)

include(${CMAKE_CURRENT_LIST_DIR}/../house/run.cmake)

function(require_file pattern)
  file(GLOB_RECURSE found ${WORK_DIR}/prefix/${pattern})
  if(NOT found)
    message(FATAL_ERROR "not installed: ${pattern}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
require_file(include/tetravox/render.h)
require_file(share/doc/tetravox/LICENSE)
if(WITH_IO)
  require_file(include/tetravox/io.h)
  require_file(bin/tetravox)
  require_file(libexec/tetravox/tetravox-reader)
endif()

# Installed files must not point back into the source or build tree.
file(GLOB_RECURSE package_files ${WORK_DIR}/prefix/*.cmake)
foreach(package_file IN LISTS package_files)
  file(READ ${package_file} text)
  string(FIND "${text}" "${SOURCE_DIR}/" position)
  if(NOT position EQUAL -1)
    message(FATAL_ERROR "${package_file} names the source tree ${SOURCE_DIR}")
  endif()
endforeach()

# A program builds on the installed package alone.
function(build_program source name)
  run(${CMAKE_COMMAND} -S ${source} -B ${WORK_DIR}/${name} -G Ninja -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
  run(${CMAKE_COMMAND} --build ${WORK_DIR}/${name})
endfunction()
build_program(${SOURCE_DIR}/examples/minimal minimal)
run(${WORK_DIR}/minimal/minimal)

if(WITH_IO)
  file(WRITE ${WORK_DIR}/cell.vtk "# vtk DataFile Version 3.0\none tetrahedron\nASCII\nDATASET UNSTRUCTURED_GRID\n"
    "POINTS 4 float\n0 0 0  1 0 0  0 1 0  0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
    "POINT_DATA 4\nSCALARS height float 1\nLOOKUP_TABLE default\n0 0 0 1\n")

  # The installed tool finds the installed reader by itself.
  run(${CMAKE_COMMAND} -E env --unset=TETRAVOX_READER
    ${WORK_DIR}/prefix/bin/tetravox render ${WORK_DIR}/cell.vtk --resolution 64,48 -o ${WORK_DIR}/cell.png)

  # A program elsewhere is told where it is.
  build_program(${SOURCE_DIR}/tests/install/reading reading)
  run(${CMAKE_COMMAND} -E env TETRAVOX_READER=${WORK_DIR}/prefix/libexec/tetravox/tetravox-reader
    ${WORK_DIR}/reading/reading ${WORK_DIR}/cell.vtk ${WORK_DIR}/reading.png)
  foreach(picture cell.png reading.png)
    if(NOT EXISTS ${WORK_DIR}/${picture})
      message(FATAL_ERROR "${picture} was not written")
    endif()
  endforeach()
endif()
