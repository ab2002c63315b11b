# Install rules, and the CMake package: find_package(tetravox) gives tetravox::core and, where built, tetravox::io.

include(CMakePackageConfigHelpers)

set(TETRAVOX_PACKAGE_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/tetravox")

# What `make build` builds: the libraries and, with io, the tool and its reader.
set(TETRAVOX_LIBRARIES tetravox_support tetravox_optics tetravox_mesh tetravox_grid tetravox_scene tetravox_sort tetravox_cpu tetravox_core)
set(TETRAVOX_PROGRAMS "")
if(TETRAVOX_WITH_GL)
  list(APPEND TETRAVOX_LIBRARIES tetravox_gl)
endif()
if(TETRAVOX_WITH_IO)
  list(APPEND TETRAVOX_LIBRARIES tetravox_io)
  list(APPEND TETRAVOX_PROGRAMS tetravox tetravox-reader)
endif()
add_custom_target(product)
add_dependencies(product ${TETRAVOX_LIBRARIES} ${TETRAVOX_PROGRAMS})

# Static libraries leave it to the program at the end to link what they are made of; tetravox-config.cmake finds it.
function(tetravox_link_installed target)
  foreach(dependency IN LISTS ARGN)
    set_property(TARGET ${target} APPEND PROPERTY
      INTERFACE_LINK_LIBRARIES "$<INSTALL_INTERFACE:$<LINK_ONLY:${dependency}>>")
  endforeach()
endfunction()
if(TETRAVOX_WITH_GL)
  tetravox_link_installed(tetravox_gl PkgConfig::EPOXY)
endif()
if(TETRAVOX_WITH_IO)
  tetravox_link_installed(tetravox_io pugixml::pugixml PNG::PNG PkgConfig::OPENEXR)
endif()

install(TARGETS ${TETRAVOX_LIBRARIES} EXPORT tetravox-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT tetravox-targets NAMESPACE tetravox:: DESTINATION ${TETRAVOX_PACKAGE_DIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/tetravox DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h" PATTERN "io.h" EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(TETRAVOX_WITH_IO)
  install(FILES ${PROJECT_SOURCE_DIR}/include/tetravox/io.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tetravox)
  install(TARGETS tetravox RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(TARGETS tetravox-reader RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/tetravox)
endif()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/tetravox-config.cmake.in
  ${PROJECT_BINARY_DIR}/cmake/tetravox-config.cmake INSTALL_DESTINATION ${TETRAVOX_PACKAGE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cmake/tetravox-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/cmake/tetravox-config.cmake
  ${PROJECT_BINARY_DIR}/cmake/tetravox-config-version.cmake DESTINATION ${TETRAVOX_PACKAGE_DIR})
