#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Proves that a bare Debian 12 with git is enough: makes one in a folder, clones the present commit into it, and runs
# there what a newcomer runs. Needs root and debootstrap. Where packages come from is read from this machine's apt.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/fresh_machine.sh [--demo-only] [--keep] [--dir FOLDER]

  ./dev demo, twice     the first within 10 minutes, the second within 15 seconds
  ./dev test            as root, then in a second clone as an ordinary user without sudo

  --demo-only    leave out the tests
  --keep         leave the root standing (its folder is printed); it is used again when given by --dir
  --dir FOLDER   make the root there (default: a new folder under ${TMPDIR:-/var/tmp})
TEXT
}

demo_only=false keep=false folder=""
while [ $# -gt 0 ]; do
  case "$1" in
    --demo-only) demo_only=true;;
    --keep) keep=true;;
    --dir) folder=${2:?--dir wants a folder}; shift;;
    -h|--help) usage; exit 0;;
    *) usage >&2; exit 2;;
  esac
  shift
done

checkout=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
suite=bookworm
first_demo_limit=600 second_demo_limit=15

step() { printf '%s\n' "== $*"; }
die() { printf '%s\n' "fresh_machine: $*" >&2; exit 1; }

[ "$(id -u)" -eq 0 ] || die "run it as root (chroot and mount need it)"
command -v debootstrap >/dev/null || die "debootstrap is missing: apt-get install debootstrap"

# In a mount namespace of its own, so that no mount outlives this process, however it ends.
if [ "${FRESH_MACHINE_INNER:-}" != 1 ] && unshare --mount --propagation private true 2>/dev/null; then
  export FRESH_MACHINE_INNER=1
  options=(); $demo_only && options+=(--demo-only); $keep && options+=(--keep)
  [ -z "$folder" ] || options+=(--dir "$folder")
  exec unshare --mount --propagation private "$0" "${options[@]}"
fi

# The URI of this machine's first apt source that carries exactly the given suite, in either notation.
uri_of() {
  { cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources 2>/dev/null || true; } |
    awk -v want="$1" '
      function done() {
        if (uri != "" && index(" " suites " ", " " want " ")) { print uri; found = 1; exit }
        uri = suites = ""
      }
      /^[ \t]*#/ { next }
      /^deb[ \t]/ { sub(/\[[^]]*\]/, ""); if ($3 == want) { print $2; found = 1; exit } next }
      /^[ \t]*$/ { done(); next }
      /^Types:/ { done() }
      /^URIs:/ { uri = $2 }
      /^Suites:/ { $1 = ""; suites = $0 }
      END { if (!found) done() }'
}

mounted=()
attach() {  # target, mount arguments...
  local target=$1; shift
  mkdir -p "$target"
  mount "$@" "$target"
  mounted=("$target" "${mounted[@]}")
}
leave() {
  local code=$?
  trap - EXIT
  local target
  for target in "${mounted[@]}"; do umount -l "$target" 2>/dev/null || true; done
  if $keep; then
    step "kept: $folder"
  elif [ -n "$folder" ] && ! grep -qs " $folder/" /proc/self/mounts; then
    rm -rf --one-file-system "$folder"
  fi
  exit "$code"
}
trap leave EXIT
trap 'exit 130' INT TERM

make_root() {
  local mirror; mirror=$(uri_of $suite)
  [ -n "$mirror" ] || die "no apt source of this machine carries $suite"
  step "debootstrap $suite (minbase, git, ca-certificates)"
  debootstrap --variant=minbase --include=git,ca-certificates $suite "$folder" "$mirror" >"$folder.log" 2>&1 ||
    { tail -n 20 "$folder.log"; die "debootstrap failed"; }
  rm -f "$folder.log"
  {
    echo "deb $mirror $suite main"
    [ -z "$(uri_of $suite-updates)" ] || echo "deb $(uri_of $suite-updates) $suite-updates main"
    [ -z "$(uri_of $suite-security)" ] || echo "deb $(uri_of $suite-security) $suite-security main"
  } >"$folder/etc/apt/sources.list"
  # What this machine's apt needs to reach them: proxies, certificates, logins.
  local file
  for file in $(grep -lis 'proxy\|Acquire::https' /etc/apt/apt.conf /etc/apt/apt.conf.d/* || true); do
    cp "$file" "$folder/etc/apt/apt.conf.d/"
  done
  cp -r /etc/apt/auth.conf.d/. "$folder/etc/apt/auth.conf.d/" 2>/dev/null || true
  [ ! -f /etc/apt/auth.conf ] || cp /etc/apt/auth.conf "$folder/etc/apt/"
  cp -r /usr/local/share/ca-certificates/. "$folder/usr/local/share/ca-certificates/" 2>/dev/null || true
}

enter_root() {
  attach "$folder/proc" -t proc proc
  attach "$folder/sys" --rbind /sys
  attach "$folder/dev" --rbind /dev
  attach "$folder/dev/shm" -t tmpfs -o mode=1777 tmpfs
  attach "$folder/run" -t tmpfs -o mode=755 tmpfs
  install -d -m 1777 "$folder/run/lock"
  cp -L /etc/resolv.conf "$folder/etc/resolv.conf" 2>/dev/null || true
  cp -L /etc/hosts "$folder/etc/hosts" 2>/dev/null || true
  chroot "$folder" update-ca-certificates >/dev/null 2>&1 || true
}

clone_to() {  # path inside the root
  rm -rf "${folder:?}$1"
  git -c safe.directory='*' -c advice.detachedHead=false clone -q --no-local "file://$checkout" "$folder$1"
  git -c safe.directory='*' -C "$folder$1" checkout -q --detach "$commit"
}

# Runs a command inside as a given user, its output on ours. The time it took is left in $took.
inside() {  # user, folder, command
  local begin=$SECONDS code=0
  chroot "$folder" runuser -u "$1" -- env -i HOME="$(chroot "$folder" getent passwd "$1" | cut -d: -f6)" \
    PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 CI=true USER="$1" \
    ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} \
    ${no_proxy:+no_proxy="$no_proxy"} bash -c "cd '$2' && $3" </dev/null || code=$?
  took=$((SECONDS - begin))
  return $code
}

summary=() failed=0
judge() {  # name, exit code, limit in seconds or 0
  local verdict=ok
  if [ "$2" -ne 0 ]; then verdict="FAILED (exit $2)"
  elif [ "$3" -ne 0 ] && [ "$took" -gt "$3" ]; then verdict="FAILED (limit $3 s)"; fi
  [ "$verdict" = ok ] || failed=1
  summary+=("$(printf '%-34s %5d s  %s' "$1" "$took" "$verdict")")
  step "${summary[-1]}"
}
run() {  # name, limit, user, folder, command
  step "$1"
  local code=0
  inside "$3" "$4" "$5" || code=$?
  judge "$1" "$code" "$2"
}

commit=$(git -c safe.directory='*' -C "$checkout" rev-parse HEAD)
[ -z "$(git -c safe.directory='*' -C "$checkout" status --porcelain)" ] ||
  step "note: changes that are not committed are not tested"
[ -n "$folder" ] || folder=$(mktemp -d "${TMPDIR:-/var/tmp}/fresh_machine.XXXXXX")
mkdir -p "$folder"
[ -x "$folder/usr/bin/git" ] || make_root
enter_root
clone_to /opt/chimera
run "demo, first" $first_demo_limit root /opt/chimera './dev demo'
run "demo, again" $second_demo_limit root /opt/chimera './dev demo'
if ! $demo_only; then
  run "tests as root" 0 root /opt/chimera './.ci/run'
  chroot "$folder" id newcomer >/dev/null 2>&1 || chroot "$folder" useradd -m -s /bin/bash newcomer
  clone_to /srv/newcomer
  chroot "$folder" chown -R newcomer: /srv/newcomer
  run "tests as an ordinary user" 0 newcomer /srv/newcomer './.ci/run'
fi

echo
printf '%s\n' "fresh Debian $suite, commit ${commit:0:10}" "${summary[@]}"
exit $failed
