# Proves that the core needs neither VTK nor OpenGL: builds it where CMake can find neither, installs it, builds a
# program on it, and looks at what that program links.

cmake_minimum_required(VERSION 3.25)

include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

function(refuse text pattern place)
  string(REGEX MATCH "[^\n]*${pattern}[^\n]*" found "${text}")
  if(found)
    message(FATAL_ERROR "${place} refers to VTK or OpenGL: ${found}")
  endif()
endfunction()

file(MAKE_DIRECTORY ${WORK_DIR})
# One instruction set, hardly optimised, is enough to see what is linked, and takes a fraction of the time.
run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR}/build -G Ninja -DCMAKE_BUILD_TYPE=None
  -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_COMPILER_LAUNCHER=${COMPILER_LAUNCHER}
  "-DCMAKE_CXX_FLAGS=-O1 -DHWY_COMPILE_ONLY_STATIC" -DTETRAVOX_WITH_IO=OFF -DTETRAVOX_WITH_GL=OFF
  -DTETRAVOX_WITH_TESTS=OFF -DTETRAVOX_WITH_BENCH=OFF
  -DCMAKE_DISABLE_FIND_PACKAGE_VTK=ON -DCMAKE_DISABLE_FIND_PACKAGE_OpenGL=ON)
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build --parallel 2 --target product)
run(${CMAKE_COMMAND} -DBUILD_DIR=${WORK_DIR}/build -DSOURCE_DIR=${SOURCE_DIR} -DWORK_DIR=${WORK_DIR}/install
  -DWITH_IO=OFF -P ${SOURCE_DIR}/tests/install/install_test.cmake)

set(program ${WORK_DIR}/install/minimal/minimal)
file(READ ${WORK_DIR}/build/compile_commands.json commands)
refuse("${commands}" "include/vtk" "a compile command")
run(ldd ${program})
refuse("${output}" "lib(vtk|GL|EGL|OpenGL|epoxy)[^\n]*" "the linked program")
run(nm --demangle --dynamic ${program})
refuse("${output}" " (vtk[A-Z]|gl[A-Z]|egl[A-Z])" "the program's symbols")
run(nm --demangle ${program})
refuse("${output}" " (vtk[A-Z]|glX|egl[A-Z])" "the program's symbols")
file(GLOB libraries ${WORK_DIR}/install/prefix/lib*/libtetravox_*.a ${WORK_DIR}/install/prefix/lib/*/libtetravox_*.a)
list(LENGTH libraries count)
if(count LESS 5)
  message(FATAL_ERROR "expected a library for each folder of the core, found ${count}")
endif()
run(nm --demangle ${libraries})
refuse("${output}" " (vtk[A-Z]|gl[A-Z]|egl[A-Z])" "a library of the core")
