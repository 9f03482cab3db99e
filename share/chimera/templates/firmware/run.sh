#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: ./run.sh [--no-run] [--detail]    builds the image, runs it in QEMU, compares it with this machine
set -e
cd "$(dirname "$0")"
[ -d build ] || cmake -B build -Dchimera_DIR=@PACKAGE@
cmake --build build
exec python3 @FIRMWARE@/make.py image.yaml --program @PROGRAM@ --out build/image "$@"
