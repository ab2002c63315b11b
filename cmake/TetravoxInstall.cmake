# Install rules, and the CMake package: find_package(tetravox) gives tetravox::core and, where built, tetravox::io.

include(CMakePackageConfigHelpers)

set(TETRAVOX_PACKAGE_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/tetravox")

# What `make build` builds: the libraries and, with io, the tool and its reader.
set(TETRAVOX_LIBRARIES tetravox_support tetravox_optics tetravox_mesh tetravox_scene tetravox_cpu tetravox_core)
set(TETRAVOX_PROGRAMS "")
if(TETRAVOX_WITH_IO)
  list(APPEND TETRAVOX_LIBRARIES tetravox_io)
  foreach(program tetravox tetravox-reader)
    if(TARGET ${program})
      list(APPEND TETRAVOX_PROGRAMS ${program})
    endif()
  endforeach()
endif()
add_custom_target(product)
add_dependencies(product ${TETRAVOX_LIBRARIES} ${TETRAVOX_PROGRAMS})

# The run-time dispatch of the kernels lives in libhwy, which a program links at the end.
set_property(TARGET tetravox_cpu APPEND PROPERTY
  INTERFACE_LINK_LIBRARIES "$<INSTALL_INTERFACE:$<LINK_ONLY:PkgConfig::HWY>>")

install(TARGETS ${TETRAVOX_LIBRARIES} EXPORT tetravox-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT tetravox-targets NAMESPACE tetravox:: DESTINATION ${TETRAVOX_PACKAGE_DIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/tetravox DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h" PATTERN "io.h" EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(TETRAVOX_WITH_IO)
  install(FILES ${PROJECT_SOURCE_DIR}/include/tetravox/io.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tetravox)
  if(TARGET tetravox)
    install(TARGETS tetravox RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  endif()
  if(TARGET tetravox-reader)
    install(TARGETS tetravox-reader RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR})
  endif()
endif()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/tetravox-config.cmake.in
  ${PROJECT_BINARY_DIR}/cmake/tetravox-config.cmake INSTALL_DESTINATION ${TETRAVOX_PACKAGE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cmake/tetravox-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/cmake/tetravox-config.cmake
  ${PROJECT_BINARY_DIR}/cmake/tetravox-config-version.cmake DESTINATION ${TETRAVOX_PACKAGE_DIR})
