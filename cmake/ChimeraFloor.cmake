# SPDX-License-Identifier: Apache-2.0
# chimera_floor(NAME [LINKS floor...] [LIBRARIES lib...] [EXCEPTIONS [TEXT]] [TOGETHER])
#   One floor of the library: every x.cc of the folder makes the static library chimera_NAME,
#   every x_test.cc goes into one test binary NAME_test. Suffixes choose where a file goes:
#     x_test.cc           debug (address+undefined sanitizers)
#     x_process_test.cc   debug; uses real processes, label "process"
#     x_threads_test.cc   debug, with the process tests, and again under the thread sanitizer, label "threads"
#     x_realtime_test.cc  release only, label "realtime"
#     x_fuzz.cc           debug (replays its corpus) and fuzz (clang, libFuzzer), see chimera_fuzz
#     x_stress.cc         release; the program x_stress, a campaign for tests/stress.txt
#   Without EXCEPTIONS the floor is built with -fno-exceptions -fno-rtti (floors 0 to 5).
#   TEXT: a floor of JSON and other texts, slow to compile and without memory of its own making. Its files are compiled
#   sixteen at a time (./dev lint looks at each alone) and with fewer checks of the sanitizers.
#   TOGETHER: a floor of many files. They are compiled eight at a time in every tree but release, whose code is
#   measured.
# chimera_tests(NAME LIBS lib... [DEPENDS target...] [MEMORY])
#   The test half alone, for folders without a library. DEPENDS: targets the tests run (programs, components).
#   MEMORY: with every check of the sanitizers, for floors that make memory of their own (0 to 5). Others are compiled
#   with fewer, a fifth faster.
# chimera_script_test(NAME LABEL label [TREES tree...] [DEPENDS target...] COMMAND command...)
#   A test that is a command. Exit 77 = skipped, the last line of its output is the reason.
#   Labels: unit program (runs whole programs) hostile process page model firmware (debug), threads (tsan), symbol cost
#   realtime (release).
#   TREES: debug (default) tsan release.

find_package(Threads REQUIRED)
set(CHIMERA_PYTHON /usr/bin/python3 CACHE FILEPATH "Debian's: the one with python3-yaml and jsonschema")

if(CHIMERA_FUZZ)
  set(CHIMERA_TREE fuzz)
elseif(CHIMERA_SANITIZE STREQUAL "thread")
  set(CHIMERA_TREE tsan)
elseif(CHIMERA_SANITIZE)
  set(CHIMERA_TREE debug)
else()
  set(CHIMERA_TREE release)
endif()

add_library(chimera_flags INTERFACE)
target_include_directories(chimera_flags INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_options(chimera_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -ffp-contract=off -fPIC -fno-semantic-interposition)
if(CHIMERA_FUZZ)
  # clang warns about other things than g++; g++ is the compiler that judges.
  target_compile_options(chimera_flags INTERFACE -w -fsanitize=fuzzer-no-link)
else()
  target_compile_options(chimera_flags INTERFACE -Werror)
endif()
if(CHIMERA_SANITIZE)
  # Without vptr: that check wants the type information which floors 0 to 5 do not have.
  target_compile_options(chimera_flags INTERFACE
    -fsanitize=${CHIMERA_SANITIZE} -fno-sanitize=vptr -fno-sanitize-recover=all -fno-omit-frame-pointer -g1)
  # -Og compiles in half the time of -O1; a fuzzer lives from executions.
  target_compile_options(chimera_flags INTERFACE $<IF:$<BOOL:${CHIMERA_FUZZ}>,-O1,-Og>)
  target_link_options(chimera_flags INTERFACE -fsanitize=${CHIMERA_SANITIZE})
  if(CHIMERA_TREE STREQUAL "debug")
    # The data of the checks has a million addresses; a program that is not relocated starts in half the time.
    string(APPEND CMAKE_EXE_LINKER_FLAGS " -no-pie")
  endif()
else()
  target_compile_options(chimera_flags INTERFACE -O2 -g1)
endif()
if(CHIMERA_TREE STREQUAL "tsan")
  target_compile_definitions(chimera_flags INTERFACE CHIMERA_WORDWISE_COPY=1)
endif()

# A null pointer, and an access beyond an object, are caught by the address sanitizer all the same; these checks are a
# third of what a test takes to compile.
set(CHIMERA_FEWER_CHECKS -fno-sanitize=null,alignment,object-size,pointer-overflow)
if(CHIMERA_TREE STREQUAL "debug")
  # What the undefined-behaviour sanitizer knows of each place would be a guarded variable of its own, which a program
  # registers when it starts: four fifths of its data. Arrays of known size are checked by that sanitizer.
  list(APPEND CHIMERA_FEWER_CHECKS --param=asan-globals=0)
endif()

# Everything `./dev test` runs in this tree; `all` in the debug tree, less in the others.
add_custom_target(tests_needed)
# Everything that the tests labelled "unit" of this tree run: ./dev test --quick.
add_custom_target(tests_quick)
if(CHIMERA_FUZZ)
  add_custom_target(fuzz_targets)
endif()

# gtest precompiled once, reused by every test binary.
if(CHIMERA_TESTS)
  find_package(GTest REQUIRED)
  if(NOT TARGET chimera_gtest)
    file(WRITE ${CMAKE_BINARY_DIR}/gtest_pch.cc "// carries the precompiled gtest header\n")
    add_library(chimera_gtest STATIC EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/gtest_pch.cc)
    target_link_libraries(chimera_gtest PUBLIC chimera_flags GTest::gtest Threads::Threads)
    target_compile_options(chimera_gtest PUBLIC -fpch-preprocess)  # without it ccache never hits
    target_precompile_headers(chimera_gtest PRIVATE <gtest/gtest.h>)
  endif()
endif()

function(_chimera_test_properties name label)
  # The leak check of g++ 12 follows thread-local memory of objects that were unloaded, and crashes now and then.
  set(environment ASAN_OPTIONS=intercept_tls_get_addr=0 GTEST_OUTPUT=xml:${CMAKE_BINARY_DIR}/results/${name}.xml
    CHIMERA_BUILD=${CMAKE_BINARY_DIR} CHIMERA_SOURCE=${CMAKE_SOURCE_DIR} XDG_STATE_HOME=${CMAKE_BINARY_DIR}/state)
  set_tests_properties(${name} PROPERTIES LABELS "${label}" TIMEOUT 900 SKIP_RETURN_CODE 77
    ENVIRONMENT "${environment}")
  if(label STREQUAL "realtime")
    set_tests_properties(${name} PROPERTIES RUN_SERIAL TRUE)
  endif()
  # Those of 10 s and more begin first: the last one to begin is then a short one, and no CPU waits for it.
  if(name MATCHES "^(hostile_(files|output|values|watch|questions|ends)|(cli|library|conformance|stepped)_test)$|\
^(examples|readme|library_trials|compile_fail|applications|run_schema|run_by_processes|(cli|kill)_process_test)$|\
^processes_(requests|protocol|frames|attack|ending)$")
    set_tests_properties(${name} PROPERTIES COST 100)
  endif()
endfunction()

# _chimera_together(list folder [MOST n]): replaces the .cc files of the named list with files, in `folder` of the
# binary directory, that include up to n of them each, 8 by default: headers and templates are compiled once for all of
# them. With 16 in place of 8 two files of the manager took 31.9 s in place of 42.7, two of the command line 25.7 in
# place of 42.2 (debug). Not CMake's own unity build: no cache knows its absolute paths in another checkout.
function(_chimera_together name_of_list to)
  cmake_parse_arguments(arg "" "MOST" "" ${ARGN})
  if(NOT arg_MOST)
    set(arg_MOST 8)
  endif()
  set(together ${${name_of_list}})
  list(FILTER together INCLUDE REGEX "\\.cc$")
  set(made ${${name_of_list}})
  list(FILTER made EXCLUDE REGEX "\\.cc$")
  set(number 0)
  while(together)
    set(text "")
    foreach(i RANGE 1 ${arg_MOST})
      list(POP_FRONT together file)
      cmake_path(ABSOLUTE_PATH file)
      cmake_path(RELATIVE_PATH file BASE_DIRECTORY ${CMAKE_SOURCE_DIR})
      string(APPEND text "#include \"${file}\"\n")
      if(NOT together)
        break()
      endif()
    endforeach()
    set(path ${CMAKE_CURRENT_BINARY_DIR}/${to}/${number}.cc)
    file(CONFIGURE OUTPUT ${path} CONTENT "${text}" @ONLY)
    list(APPEND made ${path})
    math(EXPR number "${number} + 1")
  endwhile()
  set(${name_of_list} ${made} PARENT_SCOPE)
endfunction()

function(_chimera_test_binary target label sources libs depends)  # [compile options...]
  add_executable(${target} ${sources})
  target_compile_options(${target} PRIVATE ${ARGN})
  target_link_libraries(${target} PRIVATE ${libs} chimera_gtest GTest::gtest_main)
  target_precompile_headers(${target} REUSE_FROM chimera_gtest)
  if(CHIMERA_LAUNCHER_WITH_PCH)
    set_target_properties(${target} PROPERTIES CXX_COMPILER_LAUNCHER "${CHIMERA_LAUNCHER_WITH_PCH}")
  endif()
  add_test(NAME ${target} COMMAND ${target} WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
  _chimera_test_properties(${target} ${label})
  add_dependencies(tests_needed ${target} ${depends})
  if(label STREQUAL "unit")
    add_dependencies(tests_quick ${target} ${depends})
  endif()
endfunction()

# _chimera_linked_test(TARGET file library component...): a test that is linked with these components; debug tree only.
function(_chimera_linked_test target file library)
  if(NOT CHIMERA_TREE STREQUAL "debug" OR NOT CHIMERA_TESTS)
    return()
  endif()
  set(sources ${file})
  foreach(component ${ARGN})
    list(APPEND sources $<TARGET_OBJECTS:component_${component}_objects>)
  endforeach()
  _chimera_test_binary(${target} unit "${sources}" "chimera_component_base;${library}" "" ${CHIMERA_FEWER_CHECKS})
endfunction()

function(chimera_tests name)
  cmake_parse_arguments(arg "MEMORY" "" "LIBS;DEPENDS" ${ARGN})
  if(NOT CHIMERA_TESTS)
    return()
  endif()
  set(options ${CHIMERA_FEWER_CHECKS})
  if(arg_MEMORY)
    set(options)
  endif()
  file(GLOB all CONFIGURE_DEPENDS *_test.cc */*_test.cc)
  set(plain ${all})
  list(FILTER plain EXCLUDE REGEX "_(threads|process|realtime)_test\\.cc$")
  foreach(kind threads process realtime)
    set(${kind} ${all})
    list(FILTER ${kind} INCLUDE REGEX "_${kind}_test\\.cc$")
  endforeach()
  if(CHIMERA_TREE STREQUAL "tsan")
    if(threads)
      _chimera_together(threads together_threads_tests)
      _chimera_test_binary(${name}_threads_test threads "${threads}" "${arg_LIBS}" "${arg_DEPENDS}" ${options})
    endif()
  elseif(CHIMERA_TREE STREQUAL "debug")
    if(plain)
      _chimera_together(plain together_tests)
      _chimera_test_binary(${name}_test unit "${plain}" "${arg_LIBS}" "${arg_DEPENDS}" ${options})
    endif()
    list(APPEND process ${threads})
    if(process)
      _chimera_together(process together_process_tests)
      _chimera_test_binary(${name}_process_test process "${process}" "${arg_LIBS}" "${arg_DEPENDS}" ${options})
    endif()
  elseif(realtime)
    _chimera_test_binary(${name}_realtime_test realtime "${realtime}" "${arg_LIBS}" "${arg_DEPENDS}" ${options})
  endif()
endfunction()

function(chimera_script_test name)
  cmake_parse_arguments(arg "" "LABEL" "TREES;DEPENDS;COMMAND" ${ARGN})
  if(NOT arg_TREES)
    set(arg_TREES debug)
  endif()
  if(NOT CHIMERA_TESTS OR NOT CHIMERA_TREE IN_LIST arg_TREES)
    return()
  endif()
  add_test(NAME ${name} COMMAND ${arg_COMMAND} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
  _chimera_test_properties(${name} ${arg_LABEL})
  if(arg_DEPENDS)
    add_dependencies(tests_needed ${arg_DEPENDS})
    if(arg_LABEL STREQUAL "unit")
      add_dependencies(tests_quick ${arg_DEPENDS})
    endif()
  endif()
endfunction()

# chimera_fuzz(x_fuzz LIBS lib...): x_fuzz.cc with its committed inputs, the folder x_corpus beside it.
#   Debug tree: a test of label unit replays every input. Fuzz tree: libFuzzer programs for tools/dev/fuzz.py, one
#   plain and one compiled with CHIMERA_PLANTED_DEFECT.
function(chimera_fuzz source)
  cmake_parse_arguments(arg "" "" "LIBS" ${ARGN})
  cmake_path(GET source STEM name)
  if(CHIMERA_FUZZ)
    foreach(target ${name} ${name}_planted)
      add_executable(${target} ${source}.cc)
      target_link_libraries(${target} PRIVATE ${arg_LIBS} chimera_flags)
      target_link_options(${target} PRIVATE -fsanitize=fuzzer)
      set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/targets)
      add_dependencies(fuzz_targets ${target})
    endforeach()
    target_compile_definitions(${name}_planted PRIVATE CHIMERA_PLANTED_DEFECT=1)
  elseif(CHIMERA_TREE STREQUAL "debug" AND CHIMERA_TESTS)
    add_executable(${name} ${source}.cc)
    target_compile_options(${name} PRIVATE ${CHIMERA_FEWER_CHECKS})
    target_link_libraries(${name} PRIVATE ${arg_LIBS} chimera_replay_corpus)
    string(REGEX REPLACE "_fuzz$" "_corpus" corpus ${CMAKE_CURRENT_SOURCE_DIR}/${source})
    chimera_script_test(${name} LABEL unit DEPENDS ${name} COMMAND ${name} ${corpus})
  endif()
endfunction()

function(_chimera_campaigns libs)
  if(NOT CHIMERA_TREE STREQUAL "release")
    return()
  endif()
  file(GLOB campaigns CONFIGURE_DEPENDS *_stress.cc)
  foreach(source ${campaigns})
    cmake_path(GET source STEM program)
    add_executable(${program} EXCLUDE_FROM_ALL ${source})
    target_link_libraries(${program} PRIVATE ${libs})
  endforeach()
endfunction()

function(_chimera_text target)
  target_compile_options(${target} PRIVATE ${CHIMERA_FEWER_CHECKS})
  if(CHIMERA_TREE STREQUAL "release")  # where more is inlined g++ 12 takes the storage of a variant for its content
    target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized)
  endif()
endfunction()

function(chimera_floor name)
  cmake_parse_arguments(arg "EXCEPTIONS;TEXT;TOGETHER" "" "LINKS;LIBRARIES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS *.cc */*.cc)
  list(FILTER sources EXCLUDE REGEX "_(test|fuzz|stress)\\.cc$|/(testing|bare)/")
  set(target chimera_${name})
  set(scope PUBLIC)
  if(arg_TEXT)
    _chimera_together(sources together MOST 16)
  elseif(arg_TOGETHER AND NOT CHIMERA_TREE STREQUAL "release")
    _chimera_together(sources together)
  endif()
  if(sources)
    add_library(${target} STATIC ${sources})
    if(NOT arg_EXCEPTIONS)
      target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fno-exceptions -fno-rtti>)
    endif()
    if(arg_TEXT)
      _chimera_text(${target})
    endif()
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  list(TRANSFORM arg_LINKS PREPEND chimera_)
  target_link_libraries(${target} ${scope} chimera_flags ${arg_LINKS} ${arg_LIBRARIES})
  if(arg_EXCEPTIONS)
    chimera_tests(${name} LIBS ${target})
  else()
    chimera_tests(${name} LIBS ${target} MEMORY)
  endif()
  _chimera_campaigns(${target})
endfunction()
