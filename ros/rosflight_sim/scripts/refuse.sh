#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What a launch file of ROSflight 2.x that is not there runs: prints its words before --ros-args, ends with 2.
text=
for word in "$@"; do
  [ "$word" = --ros-args ] && break
  text="$text${text:+ }$word"
done
echo "$text" >&2
exit 2
