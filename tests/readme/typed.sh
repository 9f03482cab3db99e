#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Types the README: every line of its `sh` blocks, in order, in one shell; the first that fails fails the test.
# usage: typed.sh --stand-in BUILD_TREE    with the programs of a tree, ordinary priority, and a ./dev that only knows
#                                          its commands: building and installing is typed by tools/fresh_machine.sh
#        typed.sh --real                   in the checkout, with everything, as a newcomer does
# Also refuses a command that stands in no block of the README, YAML that is in no file, and output that no lesson has.
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
readme=$source/README.md
place=$(mktemp -d)
fail() { echo "readme: $*"; exit 1; }
leave() {
  local code=$?
  [ ! -s "$place/started" ] || kill $(cat "$place/started") 2>/dev/null || true
  rm -rf "$place"
  exit $code
}
trap leave EXIT

# Blocks of one kind, without the fences.
blocks() { awk -v kind="$1" '$0 == "```" kind { on = 1; next } /^```/ { on = 0 } on' "$readme"; }

# Every `chimera WORD` and `./dev WORD` of the text, in inline code and comments too, is typed in a block; these are
# typed by tools/fresh_machine.sh (tests, uninstall) or measure this machine (bench).
elsewhere='^(\./dev (test|bench|uninstall))$'
untyped() {
  comm -23 <(grep -oE '(chimera|\./dev) [a-z]+' <(grep -oE '`[^`]+`|^[^#]*#.*|^\./dev.*' "$readme" | sed 's/^!.*//') |
             sort -u) \
           <(blocks sh | sed 's/#.*//' | grep -oE '(chimera|\./dev) [a-z]+' | sort -u) | grep -vE "$elsewhere" || true
}

stand_in() {  # build tree
  local tree; tree=$(realpath "$1")
  mkdir -p "$place/bin" "$place/checkout" "$place/home" "$place/runtime"
  chmod 700 "$place/runtime"
  ln -s "$source/examples" "$source/docs" "$place/checkout/"
  cat >"$place/bin/chimera" <<TEXT
#!/usr/bin/env bash
words=("\$@")
case " \$* " in
  *" --virtual "*) ;;
  " web "*) echo \$\$ >>"$place/started";;
  " run "*) words+=(--priority 0); echo \$\$ >>"$place/started";;
esac
exec "$tree/bin/chimera" "\${words[@]}"
TEXT
  cat >"$place/checkout/dev" <<TEXT
#!/usr/bin/env bash
"$source/dev" help | grep -q "^  \$1 " || { echo "./dev has no \$1"; exit 2; }
TEXT
  chmod +x "$place/bin/chimera" "$place/checkout/dev"
  export PATH="$place/bin:$PATH" HOME=$place/home XDG_RUNTIME_DIR=$place/runtime ASAN_OPTIONS=detect_leaks=0
  unset CHIMERA_PATH CHIMERA_SUBSYSTEM GTEST_OUTPUT
  cd "$place/checkout"
}

left=$(untyped)
[ -z "$left" ] || fail "named in the text and typed in no block: $left"
case "${1:-}" in
  --stand-in) stand_in "${2:?--stand-in wants a build tree}";;
  --real) cd "$source";;
  *) sed -n '3,6s/^# //p' "${BASH_SOURCE[0]}"; exit 2;;
esac
{ echo 'set -eE -o pipefail'
  echo 'trap '\''echo "readme: this failed: $BASH_COMMAND"'\'' ERR'
  blocks sh; } >"$place/script"
[ "$(blocks sh | grep -c '^chimera ')" -ge 20 ] || fail "fewer than 20 commands were found: were the blocks read?"
bash "$place/script" </dev/null || fail "not every command of README.md works as printed"
while IFS= read -r line; do
  grep -qxF -- "$line" drive/drive.yaml || fail "README.md quotes what drive.yaml does not say: $line"
done < <(blocks yaml)
while IFS= read -r line; do
  grep -qxF -- "$line" "$source/library/tderiv/tderiv.cc" ||
    fail "no such line in a component: $line"
done < <(blocks cpp)
while IFS= read -r line; do
  grep -qxF -- "$line" "$source"/examples/*/expected.txt || fail "README.md quotes what no lesson prints: $line"
done < <(blocks text)
for file in puma.svg sweep.svg trace.json arm.svg; do [ -s "$file" ] || fail "no $file was made"; done
echo "readme: $(blocks sh | grep -c .) lines typed"
