# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# Libraries of Debian for arm64, unpacked into build/arm64-root to link with and to run on an emulated processor. The system
# stays as it is: no foreign architecture is added to it, and nobody needs to be root.

: "${root:?tools/ready.sh sources this file}"

# Debian's servers have all architectures in one place; Ubuntu's have not.
arm64_is_there() { [[ $(release_codename) == bookworm ]]; }

ready_arm64() {
  arm64_is_there || fail "preset arm64: found ${ROSFLIGHT_OS_RELEASE:-/etc/os-release} of $(release_codename), allowed Debian 12 (bookworm)"
  ready_packages run test arm64
  take_lock arm64
  local into="$root/build/arm64-root" stamp="$root/build/.ready/arm64" key
  key="$(wanted_packages arm64-depends arm64-root)"
  [[ -d $into && -f $stamp && $(<"$stamp") == "$key" ]] && return
  say "unpacking Debian's libraries for arm64 into build/arm64-root"
  local place="$root/build/.ready/arm64-apt" log="$root/build/.ready/arm64.log"
  rm -rf "$into" "$into.new" "$stamp" "$place"
  mkdir -p "$place"/{lists/partial,cache/archives/partial,packages}
  : >"$place/status"
  local -a apt=(apt-get -o APT::Architecture=arm64 -o APT::Architectures::=arm64 -o "Dir::State::Lists=$place/lists"
    -o "Dir::State::status=$place/status" -o "Dir::Cache=$place/cache" -o "APT::Sandbox::User=" -o Debug::NoLocking=1)
  local -a names
  mapfile -t names <<<"$key"
  if ! (cd "$place/packages" && "${apt[@]}" update && "${apt[@]}" download "${names[@]}") >"$log" 2>&1; then
    tail -n 8 "$log" >&2
    fail "the libraries for arm64 could not be downloaded; the output is in $log"
  fi
  local package
  for package in "$place"/packages/*.deb; do
    dpkg-deb --extract "$package" "$into.new"
  done
  # What the Debian package of this project depends on: the libraries themselves, whose names say which release they are of.
  wanted_packages arm64-depends >"$into.new/depends"
  mv "$into.new" "$into"
  rm -rf "$place"
  printf '%s\n' "$key" >"$stamp"
}
