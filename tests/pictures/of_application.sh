#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: of_application.sh CHIMERA DESCRIPTION PICTURE   exit 0 if the picture is what `check --graph svg` draws today
set -e
drawn=$(mktemp)
trap 'rm -f "$drawn"' EXIT
"$1" check "$2" --graph svg >"$drawn"
cmp "$drawn" "$3" || { echo "draw it anew: chimera check $2 --graph svg > $3"; exit 1; }
