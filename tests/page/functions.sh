#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# usage: functions.sh ESBUILD X_test.ts...: runs tests of functions of the page, without a browser.
set -euo pipefail
esbuild=$1; shift
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
NODE_PATH=/usr/share/nodejs "$esbuild" "$@" --bundle --platform=node --log-level=warning --outdir="$place"
for test in "$place"/*.js; do node --test "$test"; done
