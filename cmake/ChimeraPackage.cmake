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
foreach(program chimera chimera-guard chimera-rtpu chimera-manager chimera-describe)
  install(PROGRAMS ${CMAKE_BINARY_DIR}/bin/${program} DESTINATION bin COMPONENT sdk)
endforeach()
install(DIRECTORY share/chimera DESTINATION share COMPONENT sdk PATTERN completion EXCLUDE)
# What an image of a microcontroller is made of, in the folders of the checkout (tools/firmware/build.py). Components of
# the library are beside their data sheets.
set(sources FILES_MATCHING PATTERN "*.h" PATTERN "*.cc" PATTERN "*.ld" REGEX "_(test|stress|fuzz)\\.cc$" EXCLUDE
  REGEX "/(hosted|preemptive|virtual|testing|images|targets|[a-z_]*_corpus)$" EXCLUDE)
foreach(folder base platform/bare table task schedule runtime)
  cmake_path(GET folder PARENT_PATH above)
  install(DIRECTORY chimera/${folder} DESTINATION share/chimera/chimera/${above} COMPONENT sdk ${sources})
endforeach()
install(FILES chimera/platform/clock.h DESTINATION share/chimera/chimera/platform COMPONENT sdk)
install(DIRECTORY firmware DESTINATION share/chimera COMPONENT sdk ${sources})
install(DIRECTORY tools/firmware DESTINATION share/chimera/tools COMPONENT sdk FILES_MATCHING PATTERN "*.py")
if(CHIMERA_WEB)
  install(PROGRAMS ${CMAKE_BINARY_DIR}/bin/chimera-web DESTINATION bin COMPONENT page)
  install(DIRECTORY ${CMAKE_BINARY_DIR}/page DESTINATION share/chimera COMPONENT page)
endif()

# The library without the test components. `product` is what `./dev install` and `./dev package` build.
get_property(names GLOBAL PROPERTY chimera_component_names)
list(FILTER names EXCLUDE REGEX "^t_")
add_custom_target(product DEPENDS chimera chimera_pages chimera-describe chimera_base)
if(CHIMERA_WEB)
  add_dependencies(product chimera-web)
endif()
foreach(name IN LISTS names)
  if(TARGET component_${name}_files)
    add_dependencies(product component_${name}_files)
  endif()
  get_property(files GLOBAL PROPERTY chimera_files_of_${name})
  foreach(file IN LISTS files)
    set(kind FILES)
    if(file MATCHES "\\.partner$")
      set(kind PROGRAMS)
    endif()
    install(${kind} ${file} DESTINATION lib/chimera/components COMPONENT sdk OPTIONAL)
  endforeach()
endforeach()
# What this tree can build, for the message about what it has not built (chimera/catalogue/library.h).
list(JOIN names "\n" buildable)
file(WRITE ${CMAKE_BINARY_DIR}/components/buildable.txt "${buildable}\n")

# What people read, in the folders of the checkout, so that its links hold: share/chimera/{docs,examples,library}.
install(FILES ${CMAKE_BINARY_DIR}/pages/chimera.bash RENAME chimera
  DESTINATION share/bash-completion/completions COMPONENT documents)
install(FILES ${CMAKE_BINARY_DIR}/pages/chimera.1 DESTINATION share/man/man1 COMPONENT documents)
install(DIRECTORY docs/formats/ DESTINATION share/chimera/schema COMPONENT documents
  FILES_MATCHING PATTERN "*.schema.json")
install(DIRECTORY examples docs DESTINATION share/chimera COMPONENT documents
  PATTERN CMakeLists.txt EXCLUDE PATTERN man EXCLUDE)
install(FILES README.md CONTRIBUTING.md DESTINATION share/chimera COMPONENT documents)
install(DIRECTORY firmware/targets DESTINATION share/chimera/firmware COMPONENT documents)  # chimera bake --target
# The recordings and stores are those that lessons name as ../../library/...; the page shows pictures and code.
file(GLOB sheets RELATIVE ${CMAKE_SOURCE_DIR} CONFIGURE_DEPENDS library/README.md library/*/README.md
  library/*/*.events library/*/*.store library/*/*.svg library/*/*.cc library/*/*.h)
list(FILTER sheets EXCLUDE REGEX "_test\\.cc$")
foreach(sheet IN LISTS sheets)
  get_filename_component(folder ${sheet} DIRECTORY)
  install(FILES ${sheet} DESTINATION share/chimera/${folder} COMPONENT documents)
endforeach()
