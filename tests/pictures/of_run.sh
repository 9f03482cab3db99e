#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: of_run.sh CHIMERA DESCRIPTION PICTURE DURATION STEP VARIABLE...   exit 0 if a run draws the picture
set -e
program=$1 description=$2 picture=$3 duration=$4 step=$5
shift 5
drawn=$(mktemp --suffix .svg)
trap 'rm -f "$drawn"' EXIT
watched=
for variable; do watched="$watched --watch $variable"; done
# shellcheck disable=SC2086
"$program" run "$description" --virtual --for "$duration" --every "$step" $watched --svg "$drawn" >"$drawn.said" || {
  cat "$drawn.said"
  rm -f "$drawn.said"
  exit 1
}
rm -f "$drawn.said"
cmp "$drawn" "$picture" || {
  echo "draw it anew: chimera run $description --virtual --for '$duration' --every '$step'$watched --svg $picture"
  exit 1
}
