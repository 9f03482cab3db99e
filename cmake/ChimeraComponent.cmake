# SPDX-License-Identifier: Apache-2.0
# chimera_component(NAME source... [LIBRARIES lib...] [RESOURCES file...])
#   One component: NAME.so and, derived from it by chimera-describe, NAME.component.json, both in
#   ${CMAKE_BINARY_DIR}/components. The build prints the methods it found and fails when the object cannot be described.
#   RESOURCES are copied beside them, and what the folder has of NAME.test.yaml, NAME.test.csv, NAME.test.partner
#   (docs/formats/component-test.md) and, when the folder is called NAME, of the data sheet README.md as NAME.md.
#   LIBRARIES are linked into the component.
#   NAME_test.cc beside the sources is linked with them (chimera/task/rig.h finds the component by its name):
#   as the test NAME_test (and, outside our own build, with NAME.test.yaml as the test trial_NAME), or, where
#   CHIMERA_COMPONENT_GROUP is set, into the group's one test binary.
# chimera_application(NAME description)
#   The tests check_NAME and run_NAME: the description is legal with the components built here and those installed,
#   and runs for a second of virtual time. With a file of cases beside it (docs/formats/cases.md; NAME.cases.yaml beside
#   NAME.yaml) the test cases_NAME, whose report for a build machine is cases_NAME.xml in the build folder.
# chimera_component_tests(GROUP [file...])
#   The test binary of all components made so far with CHIMERA_COMPONENT_GROUP set to GROUP, and of further test files.
#
# The same file serves this build and the exported package: what differs are the targets chimera::component (headers
# and base library) and chimera::describe (the tool).

# A C function that is not static and no method declared by PBO_MODULE is a misspelt method: an error.
set(CHIMERA_COMPONENT_FLAGS -fPIC -fvisibility=hidden -ffp-contract=off
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fno-gnu-unique> $<$<COMPILE_LANGUAGE:C>:-Werror=missing-prototypes>)

function(_chimera_component_tests_wanted out)
  set(${out} FALSE PARENT_SCOPE)
  if(CHIMERA_PACKAGE)  # outside our own build: a component is tested as it is built
    if(NOT DEFINED BUILD_TESTING OR BUILD_TESTING)
      set(${out} TRUE PARENT_SCOPE)
    endif()
  elseif(CHIMERA_TESTS AND CHIMERA_SANITIZE AND NOT CHIMERA_SANITIZE STREQUAL "thread")
    set(${out} TRUE PARENT_SCOPE)
  endif()
endfunction()

# Outside our own build: `chimera test NAME`, for a component that says what it needs for that.
function(_chimera_component_trial name)
  _chimera_component_tests_wanted(wanted)
  if(CHIMERA_PACKAGE AND wanted AND TARGET chimera::program AND EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${name}.test.yaml)
    add_test(NAME trial_${name} COMMAND chimera::program test ${name})
    set_tests_properties(trial_${name} PROPERTIES ENVIRONMENT "CHIMERA_PATH=${CMAKE_BINARY_DIR}/components")
  endif()
endfunction()

function(_chimera_component_test name objects libraries)
  set(test ${CMAKE_CURRENT_SOURCE_DIR}/${name}_test.cc)
  if(CHIMERA_COMPONENT_GROUP)
    set(group chimera_${CHIMERA_COMPONENT_GROUP})
    set_property(GLOBAL APPEND PROPERTY ${group}_sources $<TARGET_OBJECTS:${objects}>)
    set_property(GLOBAL APPEND PROPERTY ${group}_libraries ${libraries})
    if(EXISTS ${test})
      set_property(GLOBAL APPEND PROPERTY ${group}_sources ${test})
    endif()
    return()
  endif()
  _chimera_component_tests_wanted(wanted)
  if(NOT wanted OR NOT EXISTS ${test})
    return()
  endif()
  if(NOT TARGET GTest::gtest_main)
    message(STATUS "${name}_test.cc is not built: GoogleTest was not found")
    return()
  endif()
  add_executable(${name}_test ${test} $<TARGET_OBJECTS:${objects}>)
  target_link_libraries(${name}_test PRIVATE chimera::component ${libraries} GTest::gtest_main)
  add_test(NAME ${name}_test COMMAND ${name}_test WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
endfunction()

# Copies a file of the folder to `to`; appends it to `made`.
macro(_chimera_copy from to)
  add_custom_command(OUTPUT ${to}
    COMMAND ${CMAKE_COMMAND} -E copy_if_different ${CMAKE_CURRENT_SOURCE_DIR}/${from} ${to}
    DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${from} VERBATIM)
  list(APPEND made ${to})
endmacro()

function(chimera_component name)
  cmake_parse_arguments(arg "" "" "LIBRARIES;RESOURCES" ${ARGN})
  set(folder ${CMAKE_BINARY_DIR}/components)
  set(objects component_${name}_objects)
  add_library(${objects} OBJECT ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(${objects} PRIVATE chimera::component ${arg_LIBRARIES})
  target_compile_options(${objects} PRIVATE ${CHIMERA_COMPONENT_FLAGS})
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES AND NOT "${CMAKE_C_FLAGS} ${CMAKE_CXX_FLAGS}" MATCHES "-O")
    target_compile_options(${objects} PRIVATE -O2)  # a component without a build type is no slower than the library
  endif()

  set(module component_${name})
  add_library(${module} MODULE $<TARGET_OBJECTS:${objects}>)
  target_link_libraries(${module} PRIVATE chimera::component ${arg_LIBRARIES})
  set_target_properties(${module} PROPERTIES
    PREFIX "" OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${folder} LINKER_LANGUAGE CXX)
  if(NOT CHIMERA_SANITIZE)
    target_link_options(${module} PRIVATE -Wl,--no-undefined)
  endif()

  set(made)
  if(TARGET chimera::describe)
    add_custom_command(OUTPUT ${folder}/${name}.component.json
      COMMAND chimera::describe $<TARGET_FILE:${module}> --output ${folder}/${name}.component.json
      DEPENDS ${module} chimera::describe VERBATIM)
    list(APPEND made ${folder}/${name}.component.json)
  endif()
  foreach(resource IN LISTS arg_RESOURCES)
    get_filename_component(file ${resource} NAME)
    _chimera_copy(${resource} ${folder}/${file})
  endforeach()
  file(GLOB setups CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR}
    ${name}.test.yaml ${name}.test.csv ${name}.test.partner)
  foreach(setup IN LISTS setups)
    _chimera_copy(${setup} ${folder}/${setup})
  endforeach()
  get_filename_component(here ${CMAKE_CURRENT_SOURCE_DIR} NAME)
  if(here STREQUAL name AND EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/README.md)
    _chimera_copy(README.md ${folder}/${name}.md)
  endif()
  if(made)
    add_custom_target(${module}_files ALL DEPENDS ${made})
    set_property(GLOBAL APPEND PROPERTY chimera_component_targets ${module}_files)
  endif()
  set_property(GLOBAL APPEND PROPERTY chimera_component_names ${name})
  set_property(GLOBAL PROPERTY chimera_files_of_${name} ${folder}/${name}.so ${made})
  _chimera_component_test(${name} ${objects} "${arg_LIBRARIES}")
  _chimera_component_trial(${name})
endfunction()

function(chimera_application name description)
  set(path ${CMAKE_BINARY_DIR}/components)
  if(DEFINED ENV{CHIMERA_PATH})
    string(APPEND path ":$ENV{CHIMERA_PATH}")
  endif()
  add_test(NAME check_${name} COMMAND chimera::program check ${description})
  add_test(NAME run_${name} COMMAND chimera::program run ${description} --virtual --for "1 s")
  set(tests check_${name} run_${name})
  string(REGEX REPLACE "\\.yaml$" ".cases.yaml" cases ${description})
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${cases})
    add_test(NAME cases_${name} COMMAND chimera::program test ./${cases} --junit ${CMAKE_BINARY_DIR}/cases_${name}.xml)
    list(APPEND tests cases_${name})
  endif()
  set_tests_properties(${tests} PROPERTIES
    WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} ENVIRONMENT "CHIMERA_PATH=${path}")
endfunction()

function(chimera_component_tests group)
  get_property(sources GLOBAL PROPERTY chimera_${group}_sources)
  get_property(libraries GLOBAL PROPERTY chimera_${group}_libraries)
  list(APPEND sources ${ARGN})
  _chimera_component_tests_wanted(wanted)
  if(sources AND wanted)
    _chimera_together(sources together)
    _chimera_test_binary(${group}_test unit "${sources}" "chimera_component_base;${libraries}" ""
      ${CHIMERA_FEWER_CHECKS})
  endif()
endfunction()

if(NOT CHIMERA_PACKAGE AND NOT TARGET chimera_component_base)
  add_library(chimera_component_base INTERFACE)
  target_link_libraries(chimera_component_base INTERFACE chimera_flags chimera_base)
  add_library(chimera::component ALIAS chimera_component_base)
endif()
