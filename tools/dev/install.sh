#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Puts a staged tree into a prefix, and takes it out again. PREFIX/share/chimera/manifest lists our files: lines of
# sha256sum, and `#dir FOLDER` for each folder that did not exist before.
#   install.sh look PREFIX [BYTES]     refuses a prefix that cannot be installed into, or has no room for BYTES
#   install.sh put PREFIX STAGE        installs, or upgrades: all of it or nothing
#   install.sh remove PREFIX
set -euo pipefail
export LC_ALL=C.UTF-8

manifest=share/chimera/manifest
die() { printf '%s\n' "./dev: $*" >&2; exit 1; }
note() { printf '%s\n' "   $*"; }
files_of() { (cd "$1" && find . -type f -printf '%P\n' | sort); }
folders_of() { (cd "$1" && find . -mindepth 1 -type d -printf '%P\n' | sort); }

# The nearest folder above that exists.
standing() {
  local at=$1
  while [ ! -e "$at" ] && [ ! -L "$at" ]; do at=$(dirname "$at"); done
  printf '%s' "$at"
}

look() {  # [bytes]
  local at free; at=$(standing "$prefix")
  [ -d "$at" ] || die "$at is no folder: choose another PREFIX"
  { [ -w "$at" ] && [ -x "$at" ]; } ||
    die "$at cannot be written by $(id -un): choose a folder of yours (./dev install alone takes ~/.local)," \
      "or make packages for the whole machine: ./dev package"
  free=$(($(df --output=avail -B1 "$at" | tail -n 1)))
  [ "$free" -ge "${1:-0}" ] ||
    die "$at has room for $((free / 1000000)) MB, $((${1:-0} / 1000000 + 1)) MB are needed: nothing was installed"
  [ -e "$prefix/$manifest" ] || [ ! -e "$prefix/bin/chimera" ] ||
    die "$prefix/bin/chimera exists and was not installed by ./dev install: move it away, or choose another PREFIX"
}

named() { [ ! -e "$prefix/$manifest" ] || grep -v '^#' "$prefix/$manifest" | cut -c 67- | sort -u; }
folders_named() { [ ! -e "$prefix/$manifest" ] || sed -n 's/^#dir //p' "$prefix/$manifest"; }

# Sorts the files of the manifest into `same` (as installed) and `changed` (since then).
sort_ours() {
  local path sum
  declare -A known=()
  same=() changed=()
  [ -e "$prefix/$manifest" ] || return 0
  while IFS= read -r sum; do known[$sum]=1; done <"$prefix/$manifest"
  while IFS= read -r sum; do
    path=${sum:66}
    if [ -n "${known[$sum]:-}" ]; then same+=("$path"); else changed+=("$path"); fi
  done < <(cd "$prefix" && named | while IFS= read -r path; do [ ! -f "$path" ] || printf '%s\0' "$path"; done |
           xargs -0r sha256sum --)
}

# Refuses files that are not ours in the places of the new files.
refuse_strangers() {
  local path at strangers=()
  while IFS= read -r path; do
    at=$(standing "$prefix/$(dirname "$path")")
    { [ -d "$at" ] && [ -w "$at" ]; } || die "$at is no folder that $(id -un) can write into: nothing was installed"
    if [ -e "$prefix/$path" ] || [ -L "$prefix/$path" ]; then strangers+=("$path"); fi
  done < <(comm -23 <(files_of "$stage") <(named))
  [ ${#strangers[@]} -eq 0 ] ||
    die "$prefix/${strangers[0]} exists and was not installed by ./dev install ($((${#strangers[@]} - 1)) more" \
      "like it): move it away, or choose another PREFIX; nothing was installed"
}

lock() { exec 9<"$prefix"; flock -n 9 || die "another ./dev install or uninstall is at work in $prefix"; }
forget() { rm -rf "${fresh:?}"; [ -e "$prefix/$manifest" ] || remove_folders "${made[@]}"; }

remove_folders() {
  local folder
  while IFS= read -r folder; do
    [ "$folder" = . ] || rmdir "$prefix/$folder" 2>/dev/null || true
  done < <(printf '%s\n' "$@" | sort -ru)
  case " $* " in *" . "*) rmdir "$prefix" 2>/dev/null || true;; esac
}

put() {  # stage
  stage=$1 fresh=$prefix/.chimera-new
  look $(($(du -sb "$stage" | cut -f 1) * 11 / 10 + 1000000))
  local folder
  made=()
  [ -e "$prefix" ] || made+=(.)
  while IFS= read -r folder; do [ -e "$prefix/$folder" ] || made+=("$folder"); done < <(folders_of "$stage")
  mkdir -p "$prefix"
  lock
  refuse_strangers
  trap forget EXIT
  rm -rf "$fresh"
  cp -r --preserve=mode,timestamps "$stage" "$fresh" 2>"$stage.log" ||
    die "copying to $prefix failed, nothing was installed: $(head -n 1 "$stage.log")"
  { (cd "$stage" && find . -type f -printf '%P\0' | sort -z | xargs -0 sha256sum --)
    { printf '%s\n' "${made[@]}"; folders_named; } | sort -u | sed -n 's/^./#dir &/p'; } >"$fresh/new" ||
    die "writing to $prefix failed, nothing was installed"
  { cat "$fresh/new"; [ ! -e "$prefix/$manifest" ] || cat "$prefix/$manifest"; } >"$fresh/both" ||
    die "writing to $prefix failed, nothing was installed"
  sort_ours
  exchange
}

# Only renames and removals. Until the last is done the manifest names the old files and the new ones.
exchange() {
  local path folder
  trap '' INT TERM HUP
  while IFS= read -r folder; do mkdir -p "$prefix/$folder"; done < <(folders_of "$stage")
  mv -f "$fresh/both" "$prefix/$manifest"
  for path in "${changed[@]}"; do
    [ -e "$stage/$path" ] || { note "left where it is, because you changed it: $prefix/$path"; continue; }
    cmp -s "$stage/$path" "$prefix/$path" && continue
    mv -f "$prefix/$path" "$prefix/$path.before"
    note "you had changed $path: yours is kept as $path.before"
  done
  while IFS= read -r path; do mv -fT "$fresh/$path" "$prefix/$path"; done < <(files_of "$stage")
  while IFS= read -r path; do rm -f "${prefix:?}/$path"; done \
    < <(comm -23 <([ ${#same[@]} -eq 0 ] || printf '%s\n' "${same[@]}" | sort) <(files_of "$stage"))
  mv -f "$fresh/new" "$prefix/$manifest"
  local empty=(); mapfile -t empty < <(folders_named)
  remove_folders "${empty[@]/#./}"
}

remove() {
  local path folders=()
  [ -f "$prefix/$manifest" ] ||
    die "no Chimera of ./dev install in $prefix ($manifest is missing): nothing was removed"
  while IFS= read -r path; do
    [ -w "$prefix/$path" ] || die "$prefix/$path cannot be written by $(id -un): nothing was removed"
  done < <(named | while IFS= read -r path; do [ ! -e "$prefix/$path" ] || dirname "$path"; done | sort -u)
  lock
  sort_ours
  mapfile -t folders < <(folders_named)
  for path in "${same[@]}"; do rm -f "${prefix:?}/$path"; done
  rm -f "$prefix/$manifest"
  remove_folders "${folders[@]}"
  for path in "${changed[@]}"; do note "left where it is, because you changed it: $prefix/$path"; done
  note "removed ${#same[@]} files from $prefix"
  local state=${XDG_STATE_HOME:-${HOME:-}/.local/state}/chimera
  [ ! -d "$state" ] || note "left where it is, because it is yours: $state (receipts, events, lines of the shell)"
}

act=${1:-} prefix=${2:-}
case "$act" in
  look|put|remove) [ -n "$prefix" ] || die "install.sh $act: wants a prefix"; shift 2; "$act" "$@";;
  *) die "install.sh: no '$act'";;
esac
