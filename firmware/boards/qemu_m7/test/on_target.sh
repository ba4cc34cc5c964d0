#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs a test image on the emulated board, its arguments passed on by semihosting: on_target.sh IMAGE [ARGUMENT...]
# The first two serial ports are each other's far end. Ends with the status of the image.
set -euo pipefail

image=$1
shift
if ! command -v qemu-system-arm >/dev/null; then
  echo "qemu-system-arm is not installed: it comes with the package qemu-system-arm" >&2
  exit 2
fi
semihosting="enable=on,target=native,arg=$(basename "$image")"
for argument in "$@"; do
  semihosting+=",arg=${argument//,/,,}"
done
wire="rosflight_m7_$$"
exec qemu-system-arm -M mps2-an500 -nodefaults -display none -monitor none \
  -chardev "socket,id=near,path=$wire,abstract=on,server=on,wait=off" \
  -chardev "socket,id=far,path=$wire,abstract=on" \
  -serial chardev:near -serial chardev:far \
  -semihosting-config "$semihosting" -kernel "$image" </dev/null
