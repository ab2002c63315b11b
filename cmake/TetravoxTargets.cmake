# One function makes the target of a folder, so that every folder is compiled the same way.

# Flags of all our code: warnings are errors; products and sums are never contracted, so that every
# instruction set computes the same bits (docs/conventions.md).
add_library(tetravox_flags INTERFACE)
target_compile_features(tetravox_flags INTERFACE cxx_std_20)
target_compile_options(tetravox_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror -ffp-contract=off -pthread)
if(TETRAVOX_WITH_PRECOMPILED_HEADERS AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Headers that do not fit the flags of a target are said to, and parsed again.
  target_compile_options(tetravox_flags INTERFACE -Wno-error=invalid-pch)
endif()
# With sanitizers GCC 12 takes parts of the standard library's regular expressions for uninitialised; its manual warns of
# such false alarms.
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize=" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(tetravox_flags INTERFACE -Wno-maybe-uninitialized)
endif()

find_package(TBB REQUIRED)
tetravox_add_precompiled(library POSITION_INDEPENDENT
  LIBRARIES TBB::tbb HEADERS ${TETRAVOX_STANDARD_HEADERS} ${TETRAVOX_TBB_HEADERS})
tetravox_add_precompiled(program HEADERS ${TETRAVOX_STANDARD_HEADERS})

# tetravox_add_library(name SOURCES ... PUBLIC ... PRIVATE ...): static library tetravox_<name> of this folder.
# The include root is the project, so that an include says where a header lives ("src/mesh/adjacency.h").
function(tetravox_add_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(tetravox_${name} STATIC ${arg_SOURCES})
  add_library(tetravox::${name} ALIAS tetravox_${name})
  target_include_directories(tetravox_${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_features(tetravox_${name} PUBLIC cxx_std_20)
  target_link_libraries(tetravox_${name} PUBLIC ${arg_PUBLIC} PRIVATE $<BUILD_INTERFACE:tetravox_flags> ${arg_PRIVATE})
  set_target_properties(tetravox_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  tetravox_precompile(tetravox_${name} library)
endfunction()
