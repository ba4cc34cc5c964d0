# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# Completion of ./rosflight for bash; ./rosflight completion prints it. Commands and options come from the help texts,
# vehicles and missions from their folders, at the time of the completion, so that nothing here can be out of date.

# The project whose command is being typed; else the one this file was printed by.
_rosflight_root() {  # COMMAND
  local found
  found="$(dirname "$(readlink -f "$(command -v "$1" || echo "$1")")")"
  if [[ -d $found/apps/help ]]; then echo "$found"; else echo '@ROOT@'; fi
}

_rosflight_help() { # ROOT COMMAND
  if [[ -f $1/apps/help/$2.txt ]]; then
    cat "$1/apps/help/$2.txt"
  elif [[ -f $1/tools/$2.py ]]; then
    sed -n '/^"""/,/"""$/p' "$1/tools/$2.py"
  elif [[ $2 == test ]]; then
    sed -n '/^"""/,/"""$/p' "$1/tools/run_tests.py"
  fi
}

# The actions of params, from the headings of its help.
_rosflight_actions() { # ROOT
  sed -n '/^Subcommands:/,$s/^\([a-z][a-z]*\)$/\1/p' "$1/apps/help/params.txt"
}

# What may follow an option; fails if that is nothing special.
_rosflight_values() { # ROOT COMMAND OPTION
  local file
  case $3 in
    --vehicle)  # not the frames of ./rosflight mixer
      grep -lE '^(type|extends):' "$1"/vehicles/*.yaml | sed 's|.*/||; s|[.]yaml$||'
      ;;
    --mission) for file in "$1"/missions/*.yaml; do basename "$file" .yaml; done ;;
    --*)  # the words of a choice: --log TEXT:{plot,full,none}
      _rosflight_help "$1" "$2" | sed -n "s/^ *\(-.,\)\{0,1\}$3 [^ ]*:{\([^}]*\)}.*/\2/p" | tr ',' '\n' | grep .
      ;;
    *) return 1 ;;
  esac
}

# Leaves the words that begin with what was typed in COMPREPLY; without words, files. No mapfile: zsh has none.
_rosflight_offer() { # WORD [WORDS]
  local IFS=$'\n'
  # shellcheck disable=SC2207 # names with spaces stay whole: words end at line feeds alone
  if (($# > 1)); then
    COMPREPLY=($(compgen -W "${2// /$'\n'}" -- "$1"))
  else
    COMPREPLY=($(compgen -f -- "$1"))
  fi
}

_rosflight() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} root command words='' k
  local -a plain=()
  root="$(_rosflight_root "${COMP_WORDS[0]}")"
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    words="$("$root/rosflight" --help | sed -n 's/^  \([a-z][a-z]*\) .*/\1/p') --help --version"
    _rosflight_offer "$word" "$words"
    return
  fi
  command=${COMP_WORDS[1]}
  for ((k = 2; k < COMP_CWORD; ++k)); do
    [[ ${COMP_WORDS[k]} == -* ]] || plain+=("${COMP_WORDS[k]}")
  done
  if words="$(_rosflight_values "$root" "$command" "$before")"; then
    _rosflight_offer "$word" "$words"
    # A vehicle or mission may be a file too.
    if ((${#COMPREPLY[@]} == 0)) && [[ $before == --vehicle || $before == --mission ]]; then
      _rosflight_offer "$word"
    fi
    return
  fi
  if [[ $word == -* ]]; then
    words="$(_rosflight_help "$root" "$command" | grep -o -- '--[a-z][a-z-]*' | sort -u)"
    _rosflight_offer "$word" "$words"
    return
  fi
  case $command:${before} in
    completion:*) words='bash zsh' ;;
    params:* | calibrate:* | monitor:* | preflight:* | blackbox:*)
      # bash takes the colons of a link for ends of words, so the link may be several of them.
      case $command in
        params) words="$(_rosflight_actions "$root")" ;;
        calibrate) words='gyro accel mag baro airspeed rc esc' ;;
      esac
      for k in "${plain[@]}"; do
        case " ${words//$'\n'/ } " in *" $k "*) words='' ;; esac
      done
      ((${#plain[@]} > 0)) || words='serial: udp: tcp: pty:'
      ;;
  esac
  _rosflight_offer "$word" "$words"
  ((${#COMPREPLY[@]} > 0)) || _rosflight_offer "$word"
}

complete -o filenames -F _rosflight rosflight ./rosflight
