#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# usage: tools/demo.sh BUILD_TREE    runs the demonstration from a tree in which the target `demo` is built.
# Figure 4 of the 1994 paper in real time: joint trajectory -> PID -> Puma 560, ten seconds.
# Exit 0 only if every joint moved as it should, ended where it should and never strayed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${1:?usage: tools/demo.sh BUILD_TREE}
code=0
"$build/bin/chimera" run examples/01_puma_pid/puma_pid.yaml --for '10 s' \
  --watch q --watch error_now --every '1 s' \
  --expect 'moved >= 0.5 rad' --expect 'error_now <= 2 mrad' --expect 'max_error <= 50 mrad' || code=$?
if [ $code -eq 0 ]; then
  echo "next, the program with its whole library for your PATH, in some minutes and without root:"
  echo "  ./dev install"
fi
exit $code
