#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tools/dev/install.sh installs into a prefix, upgrades, removes, and refuses without leaving a trace. The staged trees
# are small, so that nothing is built.
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
place=$(mktemp -d)
trap 'chmod -R u+w "$place"; rm -rf "$place"' EXIT
chmod 755 "$place"
cp "$source/tools/dev/install.sh" "$place/install.sh"
n=0
fail() { echo "prefix: $*"; exit 1; }
as=()  # words before the command: another user
act() { "${as[@]}" "$place/install.sh" "$@" >"$place/out" 2>&1; }
# The tree below a folder, with contents, as one text.
picture() { (cd "$1" && find . -printf '%P %y\n' | sort; find . -type f -print0 | sort -z | xargs -0r sha256sum); }
refused() {  # message, then install.sh's words: exit code 1 with that message, and nothing in $place/p changed
  local message=$1 before; shift
  before=$(picture "$place/p" 2>/dev/null || true)
  act "$@" && fail "not refused: $*"
  grep -qF -- "$message" "$place/out" || fail "$*: expected '$message', found: $(cat "$place/out")"
  [ "$before" = "$(picture "$place/p" 2>/dev/null || true)" ] || fail "refused and changed something: $*"
  n=$((n + 1))
}
holds() { "$@" || fail "does not hold: $*"; n=$((n + 1)); }
told() { grep -qF -- "$1" "$place/out" || fail "expected '$1', found: $(cat "$place/out")"; n=$((n + 1)); }
stage() {  # folder, files...
  local file folder=$1; shift
  for file in "$@"; do mkdir -p "$(dirname "$folder/$file")"; echo "$folder/$file" >"$folder/$file"; done
}
stage "$place/one" bin/chimera lib/chimera/a.so share/chimera/docs/old.md share/chimera/e.yaml
stage "$place/two" bin/chimera lib/chimera/b.so share/chimera/e.yaml

# A prefix that is made, and goes again.
holds act put "$place/p" "$place/one"
holds [ "$(cd "$place/p" && sha256sum --quiet -c share/chimera/manifest && find . -type f | wc -l)" = 5 ]
holds act remove "$place/p"
holds [ ! -e "$place/p" ]

# Files and folders from before stay, also an empty folder.
mkdir -p "$place/p/lib" "$place/p/mine"
echo mine >"$place/p/mine/notes"
before=$(picture "$place/p")
holds act put "$place/p" "$place/one"
holds act remove "$place/p"
holds [ "$before" = "$(picture "$place/p")" ]

# An upgrade removes files that the new version lacks, with their folder, and keeps files that the user changed.
holds act put "$place/p" "$place/one"
echo changed >"$place/p/share/chimera/e.yaml"
echo new >"$place/p/lib/chimera/mine.so"
holds act put "$place/p" "$place/two"
told "yours is kept as share/chimera/e.yaml.before"
holds [ "$(cat "$place/p/share/chimera/e.yaml.before")" = changed ]
holds [ ! -e "$place/p/lib/chimera/a.so" ]
holds [ ! -e "$place/p/share/chimera/docs" ]
holds [ -e "$place/p/lib/chimera/mine.so" ]
holds [ "$(cd "$place/p" && sha256sum --quiet -c share/chimera/manifest && echo same)" = same ]
echo changed >"$place/p/share/chimera/e.yaml"
holds act remove "$place/p"
told "left where it is, because you changed it: $place/p/share/chimera/e.yaml"
holds [ "$(cat "$place/p/share/chimera/e.yaml" "$place/p/mine/notes" "$place/p/lib/chimera/mine.so")" = "changed
mine
new" ]
holds [ ! -e "$place/p/bin" ]
refused "no Chimera of ./dev install in $place/p" remove "$place/p"
rm -r "$place/p"

# Refusals.
mkdir -p "$place/p/bin"
echo foreign >"$place/p/bin/chimera"
refused "p/bin/chimera exists and was not installed by ./dev install" look "$place/p"
refused "p/bin/chimera exists and was not installed by ./dev install" put "$place/p" "$place/one"
rm "$place/p/bin/chimera"
stage "$place/p" share/chimera/e.yaml
refused "share/chimera/e.yaml exists and was not installed" put "$place/p" "$place/one"
rm -r "$place/p"
mkdir "$place/p"
echo file >"$place/p/lib"
refused "is no folder" put "$place/p" "$place/one"
refused "is no folder" put "$place/p/lib/x" "$place/one"
rm "$place/p/lib"
refused "are needed: nothing was installed" look "$place/p" 99000000000000000
exec 8<"$place/p"
flock 8
refused "another ./dev install or uninstall is at work" put "$place/p" "$place/one"
exec 8<&-
chmod 555 "$place/p"
[ "$(id -u)" -ne 0 ] || as=(setpriv --reuid=65534 --clear-groups)
refused "cannot be written by" look "$place/p/new"
refused "cannot be written by" put "$place/p" "$place/one"
as=()
chmod 755 "$place/p"

# A disk that fills while it is copied: everything is as it was.
if unshare --mount true 2>/dev/null; then
  export place source
  holds unshare --mount --propagation private bash -euo pipefail -c '
    mount -t tmpfs -o size=1m tmpfs "$place/p"
    "$place/install.sh" put "$place/p" "$place/one" >/dev/null
    before=$(find "$place/p" | sort)
    head -c 1900000 /dev/zero >"$place/two/lib/chimera/big.so"
    df() { echo Avail; echo 99000000; }  # the look before is deceived
    export -f df
    ! "$place/install.sh" put "$place/p" "$place/two" >"$place/out" 2>&1
    grep -q "nothing was installed: cp: .*No space left" "$place/out"
    [ "$before" = "$(find "$place/p" | sort)" ]
    (cd "$place/p" && sha256sum --quiet -c share/chimera/manifest)'
else
  echo "prefix: the full disk is not tried: no mount namespace for $(id -un)"
fi
echo "prefix: $n claims hold"
