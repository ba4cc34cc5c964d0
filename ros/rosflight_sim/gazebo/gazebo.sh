#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Starts Gazebo with a world: `ign gazebo` (Fortress) or `gz sim` (Harmonic, Jetty), whichever is installed, else gazebo_server, or what
# ROSFLIGHT_GAZEBO names (none: as if there were none). Ends with 2 and one line where there is none, where the plugin was not built,
# or where WORLD_FILE is not there.
#
# usage: gazebo GUI WORLD_FILE NAME=VALUE...    GUI: true or false; WORLD_FILE: "" for the project's, made of the rest
here=$(dirname "$(readlink -f "$0")")
gui=$1 world=$2
shift 2

refuse() {
  echo "gazebo: found neither ign gazebo (Fortress) nor gz sim; type: ros2 launch rosflight_sim ${ROSFLIGHT_GAZEBO_INSTEAD:-multirotor}_standalone.launch.py" >&2
  exit 2
}

if [ -n "$world" ] && { [ ! -f "$world" ] || [ ! -r "$world" ]; }; then
  echo "gazebo: world_file: found $world, allowed a file that is there (SDF), or nothing for the project's world" >&2
  exit 2
fi
if [ "${ROSFLIGHT_GAZEBO:-}" = none ]; then
  refuse
elif [ -n "${ROSFLIGHT_GAZEBO:-}" ]; then
  program=$ROSFLIGHT_GAZEBO release=${ROSFLIGHT_GAZEBO_RELEASE:-fortress} plugins=${ROSFLIGHT_GAZEBO_PLUGINS:-$here/gazebo} plain=yes
elif command -v ign >/dev/null 2>&1 && ign gazebo --versions >/dev/null 2>&1; then
  program="ign gazebo" release=fortress plugins=$here/gazebo
elif command -v gz >/dev/null 2>&1 && gz sim --versions >/dev/null 2>&1; then
  program="gz sim" plugins=$here/gazebo
  case $(gz sim --versions) in 8*) release=harmonic ;; *) release=jetty ;; esac
elif [ -x "$here/gazebo_server" ]; then
  program=$here/gazebo_server plugins=$here/gazebo release=${ROSFLIGHT_GAZEBO_RELEASE:-fortress} plain=yes
else
  refuse
fi
if [ ! -e "$plugins/librosflight_gazebo_plugin.so" ]; then
  echo "gazebo: found no librosflight_gazebo_plugin.so in $plugins: build rosflight_sim again where Gazebo's development packages are installed" >&2
  exit 2
fi
count=$# theirs=
while [ "$count" -gt 0 ]; do
  word=$1 count=$((count - 1))
  shift
  [ "$word" = --ros-args ] && theirs=yes
  [ -z "$theirs" ] && set -- "$@" "$word"
done
if [ -z "$world" ]; then
  world=$(mktemp "${TMPDIR:-/tmp}/rosflight_XXXXXX.sdf") || exit 1
  "$here/gazebo_world" "$release" "$@" >"$world" || { rm -f "$world"; exit 2; }
fi
export IGN_GAZEBO_SYSTEM_PLUGIN_PATH="$plugins:${IGN_GAZEBO_SYSTEM_PLUGIN_PATH:-}"
export GZ_SIM_SYSTEM_PLUGIN_PATH="$plugins:${GZ_SIM_SYSTEM_PLUGIN_PATH:-}"
echo "ready: $program $world"
if [ -n "${plain:-}" ]; then exec "$program" "$world"; fi
if [ "$gui" = true ]; then
  exec $program -r "$world"
fi
exec $program -s -r "$world"
