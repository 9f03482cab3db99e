#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# usage: installed.sh BUILD_TREE: what `cmake --install` puts somewhere works from any folder, without that tree.
set -eu
tree=$1
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
fail() { echo "installed: $*"; exit 1; }

cmake --install "$tree" --prefix "$place/prefix" > "$place/log" 2>&1 || { cat "$place/log"; fail "cmake --install"; }
cd "$place/prefix"
for file in bin/chimera bin/chimera-rtpu bin/chimera-manager bin/chimera-describe lib/chimera/components/gain.so \
  lib/chimera/components/gain.component.json lib/chimera/components/puma560.xml lib/chimera/components/gain.md \
  lib/chimera/components/pid_joint.test.yaml share/chimera/units.xml \
  share/chimera/schema/description.schema.json share/chimera/schema/descriptor.schema.json \
  share/chimera/schema/run.schema.json share/chimera/templates/component/CMakeLists.txt \
  share/bash-completion/completions/chimera share/man/man1/chimera.1 share/chimera/examples/README.md; do
  [ -s "$file" ] || fail "$file is missing"
done
[ -z "$(find . -name 't_*.so')" ] || fail "test components are no library"

mkdir "$place/elsewhere"
cd "$place/elsewhere"
unset CHIMERA_PATH
chimera=$place/prefix/bin/chimera
"$chimera" list | grep -q '^gain ' || fail "list does not name gain"
found=$("$chimera" list --json | grep -o '"file": "[^"]*"' | grep -vc "\"$place/prefix/" || true)
[ "$found" = 0 ] || fail "list names $found components outside the installation"
for example in "$place"/prefix/share/chimera/examples/01_*/*.yaml; do
  "$chimera" check "$example" > out 2>&1 || { cat out; fail "check $example"; }
done
example=$(ls "$place"/prefix/share/chimera/examples/01_*/*.yaml | head -1)
"$chimera" run "$example" --virtual --for '50 ms' > out 2>&1 || { cat out; fail "run $example"; }
grep -q '^ran 0.050 s' out || { cat out; fail "run $example did not come to its end"; }
"$chimera" run "$example" --virtual --for '50 ms' --json > out || fail "run --json"
mkdir -m 700 "$place/runtime"
XDG_RUNTIME_DIR=$place/runtime "$chimera" run "$example" --priority 0 --for '50 ms' > out 2>&1 ||
  { cat out; fail "run $example by processes"; }
grep -q '^ran 0.050 s' out || { cat out; fail "run $example by processes did not come to its end"; }
"$chimera" describe pid_joint > out || fail "describe"
for words in '^Refused$' '^  out-var    tau ' 'Anti-windup is conditional'; do
  grep -q "$words" out || { cat out; fail "describe shows no '$words'"; }
done
"$chimera" test gain pid_joint car puma_torque > out 2>&1 || { cat out; fail "test"; }
[ "$(grep -c ': passes ' out)" = 4 ] || { cat out; fail "test tells no four reports"; }
gain=$place/prefix/lib/chimera/components/gain.so
"$chimera" test "$gain" > out 2>&1 || { cat out; fail "test of a shared object"; }
grep -q '^.SS test$' "$place/prefix/share/man/man1/chimera.1" || fail "the manual does not know test"
echo "installed: works from any folder"
