#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# usage: installed.sh BUILD_TREE: what `cmake --install` puts somewhere works from any folder, without that tree.
set -eu
tree=$1
source=$(cd "$(dirname "$0")/../.." && pwd)
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
fail() { echo "installed: $*"; exit 1; }

cmake --install "$tree" --prefix "$place/prefix" > "$place/log" 2>&1 || { cat "$place/log"; fail "cmake --install"; }
cd "$place/prefix"
for file in bin/chimera bin/chimera-rtpu bin/chimera-guard \
  bin/chimera-manager bin/chimera-describe lib/chimera/components/gain.so \
  lib/chimera/components/gain.component.json lib/chimera/components/puma560.xml lib/chimera/components/gain.md \
  lib/chimera/components/pid_joint.test.yaml share/chimera/units.xml \
  share/chimera/schema/description.schema.json share/chimera/schema/descriptor.schema.json \
  share/chimera/schema/run.schema.json share/chimera/templates/component/CMakeLists.txt \
  share/bash-completion/completions/chimera share/man/man1/chimera.1 share/chimera/examples/README.md \
  share/chimera/README.md share/chimera/docs/formats/component-test.md share/chimera/docs/howto/operate.md \
  share/chimera/library/README.md share/chimera/library/gain/README.md share/chimera/tools/firmware/make.py \
  share/chimera/firmware/boards/image.ld share/chimera/firmware/targets/mps2-an385.yaml; do
  [ -s "$file" ] || fail "$file is missing"
done
[ -z "$(find . -name 't_*.so')" ] || fail "test components are no library"

while read -r component; do
  [ -s "lib/chimera/components/$component.so" ] || [ ! -e "$tree/components/$component.so" ] ||
    fail "the component $component was built and is not installed"
done < "$tree/components/buildable.txt"
[ "$(wc -l < "$tree/components/buildable.txt")" -ge 61 ] || fail "the library has fewer than 61 components"
# A link within the documents leads to a file that is installed, or into the source.
find share/chimera -name '*.md' -exec awk 'FNR == 1 { code = 0 } /^```/ { code = !code } code { next } {
  gsub(/`[^`]*`/, "")
  while (match($0, /\]\([^)#:]*\)/)) {
    print FILENAME ":" substr($0, RSTART + 2, RLENGTH - 3)
    $0 = substr($0, RSTART + RLENGTH)
  } }' {} + |
while IFS=: read -r file link; do
  [ -n "$link" ] || continue
  to=$(realpath -m --relative-to=share/chimera "$(dirname "$file")/$link")
  case $to in chimera|chimera/*|tests/*|tools/*|bench/*|LICENSE) continue;; esac
  case $to in library/*) [ -e "$source/${to%/README.md}/README.md" ] || continue;; esac
  [ -e "share/chimera/$to" ] || fail "$file links to $link, which is not installed"
done

mkdir "$place/elsewhere"
cd "$place/elsewhere"
unset CHIMERA_PATH
chimera=$place/prefix/bin/chimera
"$chimera" list | grep -q '^gain ' || fail "list does not name gain"
found=$("$chimera" list --json | grep -o '"file": "[^"]*"' | grep -vc "\"$place/prefix/" || true)
[ "$found" = 0 ] || fail "list names $found components outside the installation"
for example in "$place"/prefix/share/chimera/examples/01_*/*.yaml; do
  case $example in *.cases.yaml) continue;; esac
  "$chimera" check "$example" > out 2>&1 || { cat out; fail "check $example"; }
done
# Every lesson finds its files where it is installed, and in the copy that examples/README.md advises.
cp -r "$place"/prefix/share/chimera/{examples,library} .
for folder in "$place/prefix/share/chimera/examples" "$PWD/examples"; do
  for example in "$folder"/*/*.yaml; do
    cd "$(dirname "$example")"
    for named in $(grep -o '\.\./\.\./library/[^ }]*' "$example" || true); do
      [ -s "$named" ] || fail "$example names $named, which is not installed"
    done
    case $example in
      */1[012]_*) "$chimera" run "$(basename "$example")" --virtual --for '20 ms' > "$place/out" 2>&1 ||
        { cat "$place/out"; fail "run $example"; };;
    esac
  done
done
cd "$place/elsewhere"
example=$place/prefix/share/chimera/examples/01_puma_pid/puma_pid.yaml
"$chimera" run "$example" --virtual --for '50 ms' > out 2>&1 || { cat out; fail "run $example"; }
grep -q '^ran 0.050 s' out || { cat out; fail "run $example did not come to its end"; }
"$chimera" run "$example" --virtual --for '50 ms' --json > out || fail "run --json"
mkdir -m 700 "$place/runtime"
XDG_RUNTIME_DIR=$place/runtime "$chimera" run "$example" --priority 0 --for '50 ms' --operate-group "$(id -gn)" \
  > out 2>&1 || { cat out; fail "run $example by processes"; }
grep -q "^members of $(id -gn) may operate: chimera status --subsystem $place/runtime/.*/puma_pid.sock$" out ||
  { cat out; fail "run does not say what members of a group type"; }
grep -q '^ran 0.050 s' out || { cat out; fail "run $example by processes did not come to its end"; }
if [ -e "$tree/bin/chimera-web" ]; then
  code=0; timeout 5 "$chimera" web --port 0 > out 2>&1 || code=$?
  [ "$code" = 124 ] && grep -q '^http://127.0.0.1:[0-9]*/#.\{43\}$' out || { cat out; fail "web"; }
fi
"$chimera" --help | grep -q "examples: $place/prefix/share/chimera$" || fail "--help does not name the documents"
mkdir "$place/tree"
echo unbuilt > "$place/tree/buildable.txt"
printf 'subsystem: s\ntasks: {unbuilt: }\n' > unbuilt.yaml
! CHIMERA_PATH=$place/tree "$chimera" check unbuilt.yaml > out 2>&1 || fail "a component that is not built is legal"
for words in "'unbuilt' is not built" "'./dev install'"; do
  grep -qF "$words" out || { cat out; fail "check does not say how to build"; }
done
# The Debian packages have this version, and are built with the libraries that ./dev installs.
grep -q "^chimera ($("$chimera" --version))" "$source/debian/changelog" || fail "debian/changelog has another version"
for package in $(sed -n '/^demo_packages/,/^library_packages/p' "$source/dev" | grep -o '[a-z0-9-]*-dev'); do
  grep -q "[ ,]$package\(,\|$\)" "$source/debian/control" || fail "debian/control does not name $package"
done
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
