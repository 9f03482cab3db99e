# SPDX-License-Identifier: Apache-2.0
# The exported package, twice: in the build tree (lib/cmake/chimera, usable at once) and installed. Everything that
# writing, building and running components outside the checkout needs is the install component `sdk`.

function(_chimera_config file)
  configure_file(${CMAKE_SOURCE_DIR}/cmake/chimeraConfig.cmake.in ${file} @ONLY)
endfunction()

set(PACKAGE_PREFIX ${CMAKE_BINARY_DIR})
set(PACKAGE_INCLUDE ${CMAKE_SOURCE_DIR})
set(PACKAGE_BASE ${CMAKE_BINARY_DIR}/chimera/base/libchimera_base.a)
_chimera_config(${CMAKE_BINARY_DIR}/lib/cmake/chimera/chimeraConfig.cmake)
configure_file(${CMAKE_SOURCE_DIR}/cmake/ChimeraComponent.cmake
  ${CMAKE_BINARY_DIR}/lib/cmake/chimera/ChimeraComponent.cmake COPYONLY)

set(PACKAGE_PREFIX "\${CMAKE_CURRENT_LIST_DIR}/../../..")
set(PACKAGE_INCLUDE "\${_chimera_prefix}/include")
set(PACKAGE_BASE "\${_chimera_prefix}/lib/libchimera_base.a")
_chimera_config(${CMAKE_BINARY_DIR}/installed/chimeraConfig.cmake)

include(CMakePackageConfigHelpers)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/lib/cmake/chimera/chimeraConfigVersion.cmake
  VERSION ${PROJECT_VERSION} COMPATIBILITY SameMinorVersion)

foreach(floor base table task)
  install(DIRECTORY chimera/${floor} DESTINATION include/chimera COMPONENT sdk FILES_MATCHING PATTERN "*.h")
endforeach()
install(FILES ${CMAKE_BINARY_DIR}/installed/chimeraConfig.cmake cmake/ChimeraComponent.cmake
  ${CMAKE_BINARY_DIR}/lib/cmake/chimera/chimeraConfigVersion.cmake DESTINATION lib/cmake/chimera COMPONENT sdk)
install(FILES ${CMAKE_BINARY_DIR}/chimera/base/libchimera_base.a DESTINATION lib COMPONENT sdk)
foreach(program chimera chimera-rtpu chimera-manager chimera-describe)
  install(PROGRAMS ${CMAKE_BINARY_DIR}/bin/${program} DESTINATION bin COMPONENT sdk)
endforeach()
install(DIRECTORY share/chimera DESTINATION share COMPONENT sdk PATTERN completion EXCLUDE)
# Without the test components, which are no library.
install(DIRECTORY ${CMAKE_BINARY_DIR}/components/ DESTINATION lib/chimera/components COMPONENT sdk
  USE_SOURCE_PERMISSIONS PATTERN "t_*" EXCLUDE)
