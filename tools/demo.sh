#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# usage: tools/demo.sh BUILD_TREE    runs the demonstration from a tree in which the target `demo` is built.
# Exit 0 only if the demonstration itself judged its result good.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${1:?usage: tools/demo.sh BUILD_TREE}
program=$build/apps/chimera
example=examples/01_puma_pid
if [ ! -x "$program" ] || [ ! -d "$example" ]; then
  echo "demo: not there yet: ${program#"$PWD"/} or $example" >&2
  exit 1
fi
echo "demo: $example has no run step yet" >&2
exit 1
