# SPDX-License-Identifier: Apache-2.0
# Compiles through ccache when it is installed. Decided once per tree: a later installation must not change the
# command lines and with them rebuild everything. The settings travel with the command, so that a plain `cmake`
# call behaves like ./dev: paths relative to the checkout, and precompiled headers accepted. What is edited while it is
# compiled must not be kept: the times of included files are looked at.
if(NOT DEFINED CACHE{CHIMERA_CCACHE})
  find_program(CHIMERA_CCACHE ccache)
endif()
if(CHIMERA_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_DEPEND=1 CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1
    CCACHE_SLOPPINESS=pch_defines,time_macros ${CHIMERA_CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${CMAKE_CXX_COMPILER_LAUNCHER})
  # With a precompiled header the compiler's list of dependencies is of no use to another checkout.
  list(TRANSFORM CMAKE_CXX_COMPILER_LAUNCHER REPLACE "CCACHE_DEPEND=1" "CCACHE_NODEPEND=1" OUTPUT_VARIABLE
    CHIMERA_LAUNCHER_WITH_PCH)
endif()
