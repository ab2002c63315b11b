# Headers of others that most files need, parsed once for each way of compiling: a large part of the time that a build
# takes. They change no code: every file includes what it uses, and presets asan and tsan build without them, which
# shows it.

option(TETRAVOX_WITH_PRECOMPILED_HEADERS "Parse headers of the standard library, TBB, VTK and GoogleTest once" ON)

# ccache keeps what was compiled with precompiled headers only where it is told that no header of them holds __TIME__,
# and that macros defined before them do not change them.
if(TETRAVOX_WITH_PRECOMPILED_HEADERS AND CMAKE_CXX_COMPILER_LAUNCHER MATCHES "^([^;]*/)?ccache$")
  list(PREPEND CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_SLOPPINESS=pch_defines,time_macros)
endif()

set(TETRAVOX_STANDARD_HEADERS
  <algorithm> <array> <atomic> <bit> <charconv> <chrono> <cmath> <cstddef> <cstdint> <cstdlib> <cstring> <filesystem>
  <fstream> <functional> <iostream> <limits> <map> <memory> <mutex> <numbers> <numeric> <optional> <span> <sstream>
  <string> <string_view> <tuple> <utility> <variant> <vector>)
set(TETRAVOX_TBB_HEADERS
  <tbb/blocked_range.h> <tbb/enumerable_thread_specific.h> <tbb/global_control.h> <tbb/parallel_for.h>
  <tbb/parallel_reduce.h> <tbb/parallel_sort.h> <tbb/task_arena.h>)

# tetravox_add_precompiled(name [POSITION_INDEPENDENT] LIBRARIES ... HEADERS ...): headers that targets compiled with the same flags take over
# by tetravox_precompile(target name).
function(tetravox_add_precompiled name)
  if(NOT TETRAVOX_WITH_PRECOMPILED_HEADERS)
    return()
  endif()
  cmake_parse_arguments(arg "POSITION_INDEPENDENT" "" "LIBRARIES;HEADERS" ${ARGN})
  set(source ${CMAKE_CURRENT_BINARY_DIR}/precompiled_${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "// Precompiled headers belong to a target, and a target has a source.\n")
  add_library(tetravox_precompiled_${name} OBJECT ${source})
  set_target_properties(tetravox_precompiled_${name} PROPERTIES
    POSITION_INDEPENDENT_CODE ${arg_POSITION_INDEPENDENT})
  target_link_libraries(tetravox_precompiled_${name} PRIVATE tetravox_flags ${arg_LIBRARIES})
  target_precompile_headers(tetravox_precompiled_${name} PRIVATE ${arg_HEADERS})
endfunction()

# Headers `name` for all C++ of a target.
function(tetravox_precompile target name)
  if(TETRAVOX_WITH_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM tetravox_precompiled_${name})
  endif()
endfunction()
