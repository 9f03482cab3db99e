#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: ./run.sh [--virtual]    builds the application and runs it for 5 s
set -e
cd "$(dirname "$0")"
[ -d build ] || cmake -B build -Dchimera_DIR=@PACKAGE@
cmake --build build
exec @PROGRAM@ run @NAME@.yaml --for '5 s' --watch speed "$@"
