#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes a machine ready: system packages, virtual environment, build. Each step does only what is
# missing or changed and tells on stderr what it does. ./rosflight sources this file; by hand:
#
#   tools/ready.sh packages run test           what tools/system_packages.txt lists
#   tools/ready.sh venv                        .venv from tools/requirements.txt, for tests and tools
#   tools/ready.sh environment FOLDER FILE     another one, from another list
#   tools/ready.sh web run|test                the browser's page in build/web; test: also what its tests need. Makes .venv-web
#   tools/ready.sh python                      the Python package, installed in .venv-python
#   tools/ready.sh build PRESET [TARGET...]    configure and build; no target means all. Makes .venv-build
#
# ROSFLIGHT_JOBS limits compilers at work at once, ROSFLIGHT_KEEP_GOING=1 builds on after an error,
# ROSFLIGHT_PYTHON names the interpreter the environment is made with.
# Exit code 2: something this script cannot put right by itself; it prints what.
set -euo pipefail

: "${root:=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)}"

say() { printf 'rosflight: %s\n' "$*" >&2; }

fail() {
  say "$*"
  exit 2
}

# One start at a time makes one thing ready: the packages, one environment or the build of one preset. The kernel drops the
# lock when its owner ends.
take_lock() {  # NAME
  [[ ${lock_name:-} == "$1" ]] && return
  release_lock
  mkdir -p "$root/build/.ready" || fail "cannot write to $root/build"
  exec {lock_fd}>"$root/build/.ready/lock-$1" || fail "cannot write to $root/build/.ready"
  lock_name=$1
  if ! flock -n "$lock_fd"; then
    say "another start is preparing this folder, waiting for it"
    flock "$lock_fd"
  fi
}

release_lock() {
  [[ -n ${lock_fd:-} ]] && exec {lock_fd}>&-
  lock_fd=""
  lock_name=""
}

# Runs a command that a signal to this script ends too, with all that it has started.
stoppable() {  # COMMAND...
  local job status=0
  set -m  # a process group of its own
  "$@" &
  job=$!
  set +m
  trap 'kill -TERM -- "-$job" 2>/dev/null; wait "$job" 2>/dev/null || true; exit 130' INT
  trap 'kill -TERM -- "-$job" 2>/dev/null; wait "$job" 2>/dev/null || true; exit 143' TERM HUP
  wait "$job" || status=$?
  trap - INT TERM HUP
  return "$status"
}

# ---- system packages ------------------------------------------------------------------------

release_codename() {
  # shellcheck disable=SC1090,SC1091
  (. "${ROSFLIGHT_OS_RELEASE:-/etc/os-release}" && echo "${UBUNTU_CODENAME:-${VERSION_CODENAME:-}}")
}

wanted_packages() {  # SET...
  awk -v sets=" $* " -v here="@$(release_codename)" '
    { sub(/#.*/, "") }
    /^\[/ { gsub(/[][]/, ""); chosen = index(sets, " " $1 " "); next }
    chosen && (NF == 1 || $2 == here) { print $1 }' "$root/tools/system_packages.txt"
}

missing_packages() {  # NAME...
  local installed
  # shellcheck disable=SC2016
  installed="$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null || true)"
  local name
  for name in "$@"; do
    grep -qxF "installed $name" <<<"$installed" || echo "$name"
  done
}

install_packages() {  # NAME...
  local -a as_root=()
  if [[ $(id -u) != 0 ]]; then
    if sudo -n true 2>/dev/null; then
      as_root=(sudo -n)
    else
      say "system packages are missing; run this line and start again:"
      printf 'sudo apt-get update && sudo apt-get install -y --no-install-recommends %s\n' "$*" >&2
      exit 2
    fi
  fi
  local log="$root/build/.ready/apt.log"
  local -a apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600)
  say "installing system packages: $*"
  "${apt[@]}" update >"$log" 2>&1 || say "apt-get update had trouble, trying on with the old lists"
  if ! "${apt[@]}" install -y --no-install-recommends "$@" >>"$log" 2>&1; then
    tail -n 8 "$log" >&2
    fail "apt-get could not install the packages; its output is in $log"
  fi
}

ready_packages() {  # SET...
  take_lock machine
  local stamp="$root/build/.ready/packages-$*"
  [[ -f $stamp && $(<"$stamp") == "$(packages_key)" ]] && return
  local -a wanted missing=()
  mapfile -t wanted < <(wanted_packages "$@")
  if command -v dpkg-query >/dev/null; then
    mapfile -t missing < <(missing_packages "${wanted[@]}")
  else
    say "no dpkg here: please see that the contents of these packages are present: ${wanted[*]}"
  fi
  if ((${#missing[@]} > 0)); then
    install_packages "${missing[@]}"
  fi
  packages_key >"$stamp"
}

# The list and the moment dpkg last changed anything: both as before means nothing to look for.
packages_key() {
  sha256sum <"$root/tools/system_packages.txt"
  stat -c %y /var/lib/dpkg/status 2>/dev/null || true
}

# ---- virtual environment ----------------------------------------------------------------------

usable_python() {  # prints the interpreter to make the environment with
  local python
  for python in "${ROSFLIGHT_PYTHON:-/usr/bin/python3}" python3; do
    if "$python" -c 'import sys, venv, ensurepip; sys.exit(not (3, 10) <= sys.version_info < (3, 14))' 2>/dev/null; then
      echo "$python"
      return
    fi
  done
  fail "no Python 3.10 to 3.13 with the modules venv and ensurepip found"
}

# What the environment was made from: a change of any of these means work.
venv_key() {  # VENV REQUIREMENTS
  printf '%s\n%s\n' "$(sha256sum <"$2")" "$(venv_place "$1")"
}

# Environments hold absolute paths and belong to one interpreter: neither may change under them.
venv_place() { echo "$root $(readlink -f "$1/bin/python3")"; }  # VENV

# The stamp holds the key and then every entry that must be in site-packages.
venv_is_whole() {  # VENV
  local venv=$1 entry
  [[ -x $venv/bin/python3 && -f $venv/.stamp ]] || return 1
  local -a packages=("$venv"/lib/python3*/site-packages) lines
  mapfile -t lines <"$venv/.stamp"
  [[ ${#lines[@]} -gt 2 && ${lines[1]} == "$(venv_place "$venv")" ]] || return 1
  for entry in "${lines[@]:2}"; do
    [[ -e ${packages[0]}/$entry ]] || return 1
  done
}

ready_venv() { ready_environment .venv tools/requirements.txt; }

# All that a build needs of Python: quickly made, so that a first flight does not wait for what only tests use.
ready_build_venv() { ready_environment .venv-build tools/requirements-build.txt; }

# The file of ROSFLIGHT_POLICY, whose policy is built in, and what reads it.
ready_policy() {
  [[ -n ${ROSFLIGHT_POLICY:-} ]] || return 0
  [[ -f $ROSFLIGHT_POLICY ]] || fail "ROSFLIGHT_POLICY: found '$ROSFLIGHT_POLICY', allowed the path of an ONNX file"
  ROSFLIGHT_POLICY="$(readlink -f "$ROSFLIGHT_POLICY")"
  ready_environment .venv-policy tools/requirements-policy.txt
}

ready_environment() {  # FOLDER REQUIREMENTS, both from the root
  take_lock "${1#.}"
  local name=$1 listed=$2
  local venv="$root/$name" requirements="$root/$listed" log="$root/build/.ready/${name#.}.log"
  local whole=no python
  venv_is_whole "$venv" && whole=yes
  if [[ $whole == yes && $(head -n 2 "$venv/.stamp") == "$(venv_key "$venv" "$requirements")" ]]; then
    return
  fi
  if [[ $whole == no ]]; then
    say "making the Python environment $name"
    python="$(usable_python)" || exit $?
    rm -rf "$venv"
    if ! "$python" -m venv "$venv" >"$log" 2>&1; then
      tail -n 8 "$log" >&2
      fail "$python could not make $name"
    fi
  else
    say "bringing the Python environment $name up to date"
    rm -f "$venv/.stamp"
  fi
  # Compiling all dialects that pymavlink brings takes longer than the rest; what is imported is compiled then.
  if ! stoppable "$venv/bin/python3" -m pip install --disable-pip-version-check --no-input --no-compile \
    -r "$requirements" >"$log" 2>&1; then
    tail -n 8 "$log" >&2
    fail "pip could not install $listed; its output is in $log"
  fi
  venv_key "$venv" "$requirements" >"$venv/.stamp.new"
  (cd "$venv"/lib/python3*/site-packages && printf '%s\n' *) >>"$venv/.stamp.new"
  mv "$venv/.stamp.new" "$venv/.stamp"
}

# ---- the browser's page -----------------------------------------------------------------------

# All that the page is made from.
web_key() {
  (cd "$root/web" && find src build.mjs package-lock.json ../firmware/core/parameters.csv ../docs/autonomy-keys.md ../docs/vehicle-keys.md ../apps/help/fly.txt -type f -print0 | LC_ALL=C sort -z | xargs -0 sha256sum | sha256sum)
}

ready_web() {  # run|test
  ready_environment .venv-web tools/requirements-web.txt
  take_lock web
  local log="$root/build/.ready/web.log" installed="$root/web/node_modules/.stamp" stamp="$root/build/web/.stamp" lock made=
  lock="$(sha256sum <"$root/web/package-lock.json")"
  [[ -f $installed ]] && made="$(<"$installed")"
  local -a leave_out=(--omit=dev)
  [[ $1 == test ]] && leave_out=()
  if [[ $made != "$lock test" && $made != "$lock $1" ]]; then
    say "installing the packages of the browser's page"
    in_web npm ci "${leave_out[@]}" >"$log" 2>&1 || web_failed "$log" "npm could not install the packages of web/package-lock.json"
    echo "$lock $1" >"$installed"
  fi
  [[ -f $stamp && $(<"$stamp") == "$(web_key)" ]] && return
  say "building the browser's page"
  rm -f "$stamp"
  in_web node build.mjs "$root/build/web" >"$log" 2>&1 || web_failed "$log" "the page could not be built"
  web_key >"$stamp"
}

in_web() { (cd "$root/web" && PATH="$root/.venv-web/bin:$PATH" stoppable "$@"); }  # COMMAND...

web_failed() {  # LOG WHAT
  tail -n 8 "$1" >&2
  fail "$2; the output is in $1"
}

# ---- build ------------------------------------------------------------------------------------

# ccache keeps its files with the user, or in build/ when the home folder takes none.
use_ccache() {
  export CCACHE_BASEDIR="${CCACHE_BASEDIR:-$root}"
  # Without the first ccache keeps nothing that uses precompiled headers, without the second it reads them for each file.
  export CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_INODECACHE=true
  [[ -n ${CCACHE_DIR:-} ]] && return
  local place="${XDG_CACHE_HOME:-${HOME:-/nonexistent}/.cache}/ccache"
  if [[ -w ${HOME:-}/.ccache ]] || { mkdir -p "$place" && [[ -w $place ]]; }; then
    return
  fi 2>/dev/null
  export CCACHE_DIR="$root/build/ccache"
}

# As many compilers as processors, but each may need a gigabyte.
build_jobs() {
  local processors memory_kb
  processors="$(nproc)"
  memory_kb="$(awk '/^MemAvailable/ { print $2 }' /proc/meminfo)"
  local by_memory=$((memory_kb / 1000000))
  ((by_memory >= 1)) || by_memory=1
  echo "${ROSFLIGHT_JOBS:-$((processors < by_memory ? processors : by_memory))}"
}

# Passes on how far ninja is: one changing line on a terminal, else a line each tenth.
show_progress() {  # WHAT
  local line percent last=-1 shown=no
  while IFS= read -r line; do
    [[ $line =~ ^\[([0-9]+)/([0-9]+)\] ]] || continue
    percent=$((100 * BASH_REMATCH[1] / BASH_REMATCH[2]))
    if [[ -t 2 && -z ${CI:-} ]]; then
      printf '\rrosflight: building %s %3d %% ' "$1" "$percent" >&2
      shown=yes
    elif ((percent / 10 != last / 10 || last < 0)); then
      say "building $1 $percent %"
    fi
    last=$percent
  done
  [[ $shown == no ]] || printf '\n' >&2
}

# The lines of a build log a person wants to see: what failed and why, without command lines.
show_failure() {  # LOG
  grep -E -A6 'error:|CMake Error|undefined reference|FAILED:|fatal|No such file' "$1" |
    grep -v -e '^[^ ]*ccache ' -e '^--$' -e '^\[[0-9]*/' | cut -c1-200 | head -n 30 >&2 || tail -n 20 "$1" >&2
}

configure() {  # PRESET
  local build="$root/build/$1" key made_for=
  local policy=${ROSFLIGHT_POLICY:-}
  key="$root"$'\n'"$(sha256sum <"$root/CMakePresets.json")"
  [[ -z $policy ]] || key+=$'\n'$policy
  [[ -f $build/.configured ]] && made_for="$(<"$build/.configured")"
  [[ $made_for == "$key" && -f $build/build.ninja ]] && return
  say "configuring $1"
  # What was made in another place, or its old cache values, would silently win over the new ones.
  if [[ -n $made_for && ${made_for%%$'\n'*} != "$root" ]]; then
    rm -rf "$build"
  fi
  rm -rf "$build/CMakeCache.txt" "$build/CMakeFiles" "$build/.configured"
  mkdir -p "$build"
  # Quick host builds; cortex-m7 compiles file by file, which shows a missing #include.
  local -a options=()
  [[ $1 == cortex-m7 ]] || options=(-DROSFLIGHT_QUICK_BUILD=ON)
  [[ -z $policy ]] || options+=("-DROSFLIGHT_POLICY=$policy")
  if ! (cd "$root" && cmake --preset "$1" "${options[@]}") >"$build/configure.log" 2>&1; then
    show_failure "$build/configure.log"
    fail "configuring $1 failed; all of it is in $build/configure.log"
  fi
  printf '%s\n' "$key" >"$build/.configured"
}

# The commit that summaries name: a header that changes only when it does.
refresh_build_info() {  # PRESET
  local header="$root/build/$1/flight/generated/flight/build_info_values.hpp"
  [[ -f $header ]] || return 0
  cmake -DROOT="$root" -DHEADER="$header" -P "$root/cmake/build_info.cmake"
}

run_ninja() {  # PRESET NINJA...
  local preset=$1
  shift
  NINJA_STATUS='[%f/%t] ' "$@" 2>&1 </dev/null | tee "$root/build/$preset/build.log" | show_progress "$preset"
}

ready_build() {  # PRESET TARGET...
  if [[ $1 == arm64 || $1 == arm64-tests ]]; then
    # shellcheck source=tools/arm64.sh
    source "$root/tools/arm64.sh"
    ready_arm64
  fi
  ready_build_venv
  ready_policy
  take_lock "$1"
  local preset=$1
  shift
  local build="$root/build/$preset"
  use_ccache
  configure "$preset"
  refresh_build_info "$preset"
  local -a command=(ninja -C "$build" -j "$(build_jobs)")
  [[ -n ${ROSFLIGHT_KEEP_GOING:-} ]] && command+=(-k 0)
  if ! stoppable run_ninja "$preset" "${command[@]}" "$@"; then
    show_failure "$build/build.log"
    fail "the build failed; all of it is in $build/build.log"
  fi
}

# ---- the Python package -----------------------------------------------------------------------

# All that the package is made from; the page too, where it was built.
python_sources=(CMakeLists.txt CMakePresets.json pyproject.toml cmake base link messages config data firmware sim companion autonomy
  log flight python vehicles missions build/web)

# True unless a file has changed since the package was installed, or the tree has moved.
python_is_installed() {  # STAMP
  [[ -f $1 && $(<"$1") == "$(python_key)" ]] || return 1
  [[ -z ${ROSFLIGHT_POLICY:-} || ! $ROSFLIGHT_POLICY -nt $1 ]] || return 1
  local -a packages=("$root"/.venv-python/lib/python3*/site-packages/rosflight)
  [[ -d ${packages[0]} ]] || return 1
  [[ -z $(cd "$root" && find "${python_sources[@]}" -name __pycache__ -prune -o -type f -newer "$1" -print -quit 2>/dev/null) ]]
}

# The tree, and the policy that the firmware inside the package has.
python_key() {
  echo "$root"
  [[ -z ${ROSFLIGHT_POLICY:-} ]] || echo "$ROSFLIGHT_POLICY"
}

ready_python() {
  ready_packages run python
  ready_environment .venv-python tools/requirements-python.txt
  ready_policy
  take_lock python
  local stamp="$root/build/.ready/python" log="$root/build/.ready/python.log"
  python_is_installed "$stamp" && return
  say "building the Python package"
  [[ -f $stamp && $(head -n 1 "$stamp") == "$root" ]] || rm -rf "$root"/build/python-*
  rm -f "$stamp"
  python_key >"$stamp.new"  # its time is that of the sources read
  use_ccache
  # By the names that CMake finds: ccache has what the preset release compiled, Python's own name for the same compiler hides it.
  local -x CC="${CC:-cc}" CXX="${CXX:-c++}"
  local -x CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache CMAKE_BUILD_PARALLEL_LEVEL
  CMAKE_BUILD_PARALLEL_LEVEL="$(build_jobs)"
  if ! stoppable "$root/.venv-python/bin/python3" -m pip install --disable-pip-version-check --no-input --verbose --no-deps \
    --no-build-isolation --force-reinstall --config-settings="cmake.define.ROSFLIGHT_POLICY=${ROSFLIGHT_POLICY:-}" "$root" >"$log" 2>&1; then
    show_failure "$log"
    fail "the Python package could not be built; the output is in $log"
  fi
  mv "$stamp.new" "$stamp"
}

if [[ ${BASH_SOURCE[0]} == "$0" ]]; then
  case ${1:-} in
    packages | venv | environment | web | python | build) "ready_$1" "${@:2}" ;;
    *) fail "usage: tools/ready.sh packages SET... | venv | environment FOLDER FILE | web run|test | python | build PRESET [TARGET...]" ;;
  esac
fi
