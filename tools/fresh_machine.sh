#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Proves that a bare Debian 12 with git is enough: makes one in a folder, clones the present commit into it, and runs
# there what a newcomer runs. Needs root and debootstrap. Where packages come from is read from this machine's apt.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/fresh_machine.sh [--demo-only | --no-tests | --tests-only] [--keep] [--dir FOLDER] [--ccache FOLDER]

  ./dev demo, twice     the first within 10 minutes, the second within 15 seconds
  the README            every line as printed, as an ordinary user: demo, install, a control loop of one's own, ...
  ./dev install         again, over the first; a component of one's own by the steps that are printed; ./dev uninstall
  ./dev package         installed by apt; a loop of one's own with it, by an ordinary user; the unit; a boot
                        where systemd-nspawn (package systemd-container) is there; removed
  ./dev test            as root, then in a second clone as an ordinary user without sudo

  --demo-only    the demonstration alone
  --no-tests     leave out the tests
  --tests-only   run ./dev test as root alone, with an empty cache: how long it takes
  --ccache FOLDER  lend it this cache of compiled files: the times say nothing then
  --keep         leave the root standing (its folder is printed); it is used again when given by --dir
  --dir FOLDER   make the root there (default: a new folder under ${TMPDIR:-/var/tmp})
TEXT
}

demo_only=false tests=true tests_only=false keep=false folder="" cache=""
while [ $# -gt 0 ]; do
  case "$1" in
    --demo-only) demo_only=true;;
    --no-tests) tests=false;;
    --tests-only) tests_only=true;;
    --ccache) cache=$(realpath "${2:?--ccache wants a folder}"); shift;;
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
  options=(); $demo_only && options+=(--demo-only); $tests || options+=(--no-tests)
  $tests_only && options+=(--tests-only); $keep && options+=(--keep)
  [ -z "$cache" ] || options+=(--ccache "$cache")
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
  [ -z "$cache" ] || { mkdir -p "$cache"; attach "$folder/var/cache/ccache" --bind "$cache"; install_inside ccache; }
}

install_inside() {
  step "installing inside: $*"
  chroot "$folder" apt-get -qq update >/dev/null
  DEBIAN_FRONTEND=noninteractive chroot "$folder" apt-get -qq install -y --no-install-recommends "$@" >/dev/null 2>&1
}

add_user() {  # name
  chroot "$folder" id "$1" >/dev/null 2>&1 || chroot "$folder" useradd -m -s /bin/bash "$1"
}

clone_to() {  # path inside the root
  rm -rf "${folder:?}$1"
  git -c safe.directory='*' -c advice.detachedHead=false clone -q --no-local "file://$checkout" "$folder$1"
  git -c safe.directory='*' -C "$folder$1" checkout -q --detach "$commit"
}

# Runs a command inside as a given user, its output on ours. The time it took is left in $took.
inside() {  # user, folder, command
  local begin=$SECONDS code=0 lent=()
  [ -z "$cache" ] || lent=(CCACHE_DIR=/var/cache/ccache CCACHE_UMASK=000)
  [ -z "$cache" ] || [ "$1" = root ] || lent+=(CCACHE_READONLY=1 CCACHE_TEMPDIR=/tmp)  # the folder belongs to root
  chroot "$folder" runuser -u "$1" -- env -i HOME="$(chroot "$folder" getent passwd "$1" | cut -d: -f6)" \
    PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 CI=true USER="$1" \
    "${lent[@]}" \
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
if [ -z "$folder" ]; then
  folder=$(mktemp -d "${TMPDIR:-/var/tmp}/fresh_machine.XXXXXX")
  chmod 755 "$folder"  # ordinary users work in it
fi
mkdir -p "$folder"
[ -x "$folder/usr/bin/git" ] || make_root
enter_root
clone_to /opt/chimera
if $tests_only; then
  run "tests as root" 0 root /opt/chimera './.ci/run'
  printf '%s\n' "fresh Debian $suite, commit ${commit:0:10}" "${summary[@]}"
  exit $failed
fi
run "demo, first" $first_demo_limit root /opt/chimera './dev demo'
run "demo, again" $second_demo_limit root /opt/chimera './dev demo'
run "what the demo did not build" 0 root /opt/chimera \
  '! build/release/bin/chimera check examples/02_cruise_control/cruise_control.yaml >out 2>&1 &&
    grep -m 1 "dev install" out'
# An ordinary user with sudo, which ./dev asks for Debian's packages only.
as_newcomer() {
  add_user newcomer
  install_inside sudo man-db
  echo "newcomer ALL=(ALL) NOPASSWD: ALL" >"$folder/etc/sudoers.d/newcomer"
  clone_to /srv/newcomer
  chroot "$folder" chown -R newcomer: /srv/newcomer
  local found='export PATH="$HOME/.local/bin:$PATH"'
  run "the README, typed" 0 newcomer /srv/newcomer 'tests/readme/typed.sh --real'
  run "install over itself" 0 newcomer /srv/newcomer './dev install'
  run "a component by its printed steps" 0 newcomer /tmp "$found && $own_component && chimera check loop.yaml &&
    chimera run loop.yaml --virtual --for '1 s' --expect 'smooth >= 0.9 m' && man -w chimera"
  # What the README left is the newcomer's: the receipts of its switches.
  run "uninstall" 0 newcomer /srv/newcomer './dev uninstall | tee said && grep -q "state/chimera (receipts" said &&
    [ "$(find ~/.local -type f | grep -v "^$HOME/.local/state/chimera/")" = "" ] && rm -r ~/.local/state/chimera &&
    rmdir ~/.local/state ~/.local'
  rm "$folder/etc/sudoers.d/newcomer"
}

# `chimera new component`, the steps that it prints, and a description that uses it.
own_component='rm -rf filter && chimera new component filter | tee steps && sed -n "/^next:/,\$s/^  //p" steps >do.sh &&
  bash -e do.sh | tee built && grep -q "filter_test .*Passed" built &&
  export CHIMERA_PATH=$PWD/filter/build/components &&
  printf "%s\n" "subsystem: own" "tasks:" "  smooth: {component: filter, rate: 100 Hz, alias: {y: smooth}}" \
    "operator: {x: 1 m}" >loop.yaml'

as_package() {
  run "packages" 0 root /opt/chimera './dev package'
  install_inside systemd dbus
  run "apt install" 0 root /opt/chimera 'apt-get -qq install -y --no-install-recommends ./build/packages/*.deb'
  add_user ann
  chroot "$folder" usermod -a -G chimera ann
  run "a loop with the packages" 0 ann /tmp 'rm -rf drive && chimera new app drive && drive/run.sh --virtual &&
    man -w chimera && [ "$(chimera list | wc -l)" -ge 61 ]'
  run "the unit" 0 root / 'systemd-analyze verify chimera@drive.service'
  run "as the service, seen by an operator" 0 root /tmp "$as_service"
  boot
  run "apt remove" 0 root / 'apt-get -qq purge -y chimera chimera-dev &&
    [ ! -e /usr/bin/chimera ] && [ ! -e /usr/lib/chimera ] && [ ! -e /usr/share/chimera ]'
}

# No systemd runs in a chroot: the command of the unit as its user, with its folders and environment.
as_service='install -d -o chimera -g chimera -m 755 /run/chimera && cp drive/drive.yaml /etc/chimera/ &&
  install -d /usr/local/lib/chimera && cp -r drive/build/components /usr/local/lib/chimera/ &&
  unit=/lib/systemd/system/chimera@.service && start=$(sed -n "s/^ExecStart=//p" $unit | sed "s/%i/drive/") &&
  export $(sed -n "s/^Environment=//p" $unit) && (runuser -u chimera -- bash -c "CHIMERA_OPTIONS=; exec $start" & ) &&
  sleep 5 && unset XDG_RUNTIME_DIR CHIMERA_PATH &&
  runuser -u ann -- chimera status && runuser -u ann -- chimera set wanted "20 rad/s" --subsystem drive &&
  (! runuser -u nobody -- chimera status) && runuser -u ann -- chimera off control --subsystem drive &&
  runuser -u chimera -- env XDG_RUNTIME_DIR=/run chimera end --subsystem drive && sleep 2 &&
  [ ! -e /run/chimera/drive.sock ]'

# Boots the root with the service enabled, and looks at it as root and as an operator.
boot() {
  command -v systemd-nspawn >/dev/null || { summary+=("at boot: not tried, systemd-nspawn is missing"); return; }
  step "at boot"
  local target code=0 begin=$SECONDS
  for target in "${mounted[@]}"; do umount -l "$target"; done
  mounted=()
  printf '%s\n' "$at_boot" >"$folder/var/lib/at_boot.sh"
  rm -f "$folder/var/lib/at_boot.out"
  printf '%s\n' '[Service]' 'Type=oneshot' 'ExecStart=/bin/bash -ex /var/lib/at_boot.sh' \
    'ExecStopPost=systemctl --no-block poweroff' 'StandardOutput=file:/var/lib/at_boot.out' \
    'StandardError=file:/var/lib/at_boot.out' >"$folder/etc/systemd/system/at_boot.service"
  local wanted=$folder/etc/systemd/system/multi-user.target.wants
  ln -sf /etc/systemd/system/at_boot.service /lib/systemd/system/chimera@.service "$wanted/"
  mv "$wanted/chimera@.service" "$wanted/chimera@drive.service"
  timeout 180 systemd-nspawn -q --register=no --keep-unit -D "$folder" -b >/dev/null 2>&1 </dev/null || true
  rm -f "$wanted/at_boot.service" "$wanted/chimera@drive.service" "$folder/etc/chimera/bad.yaml"
  cat "$folder/var/lib/at_boot.out" || true
  grep -qx booted "$folder/var/lib/at_boot.out" || code=1
  took=$((SECONDS - begin))
  enter_root
  judge "at boot" $code 0
}

at_boot='sleep 5
systemctl is-active chimera@drive
journalctl -b -u chimera@drive --no-pager -o cat | grep "real time"
runuser -u ann -- chimera set wanted "20 rad/s" --subsystem drive
kill -9 "$(systemctl show chimera@drive -p MainPID --value)"
sleep 6
systemctl is-active chimera@drive
runuser -u ann -- chimera status | grep "^drive: all"
runuser -u chimera -- env XDG_RUNTIME_DIR=/run chimera end --subsystem drive
sleep 4
test "$(systemctl is-active chimera@drive)" = inactive
systemctl show chimera@drive -p Result | grep success
systemctl start chimera@drive
sleep 2
systemctl stop chimera@drive
systemctl show chimera@drive -p Result | grep success
sed s/drive_control/nothing_like_it/ /etc/chimera/drive.yaml >/etc/chimera/bad.yaml
systemctl start chimera@bad
sleep 15
test "$(systemctl is-active chimera@bad)" = failed
systemctl show chimera@bad -p NRestarts -p Result -p ExecMainStatus
echo booted'

if ! $demo_only; then
  as_newcomer
  as_package
fi
if ! $demo_only && $tests; then
  run "tests as root" 0 root /opt/chimera './.ci/run'
  run "tests as an ordinary user" 0 newcomer /srv/newcomer './.ci/run'
fi

echo
printf '%s\n' "fresh Debian $suite, commit ${commit:0:10}" "${summary[@]}"
exit $failed
