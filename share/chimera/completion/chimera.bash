# SPDX-License-Identifier: Apache-2.0
# Completion of `chimera` for bash: installed as share/bash-completion/completions/chimera.
# tests/install/words.py holds it and the manual against `chimera --help`.

# The options of each command, and at the top level the commands too.
_chimera_words() {
  case $1 in
    '') echo '--help --version check run list describe new' ;;
    check) echo '--help --json --graph' ;;
    run) echo '--help --for --at --watch --every --expect --trace --timeline --virtual --preemptive --seed --quantum' \
      '--priority --isolation --observe-group --operate-group --configure-group --json' ;;
    list) echo '--help --json' ;;
    describe) echo '--help --json' ;;
    new) echo '--help component app' ;;
    'new component') echo '--help --c' ;;
    'new app') echo '--help' ;;
  esac
}

_chimera_components() {
  "${COMP_WORDS[0]}" list --json 2>/dev/null | grep -o '"name": "[^"]*"' | cut -d '"' -f 4
}

_chimera() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=
  if ((COMP_CWORD > 1)); then command=${COMP_WORDS[1]}; fi
  if [[ $command == new ]] && ((COMP_CWORD > 2)); then command="new ${COMP_WORDS[2]}"; fi
  COMPREPLY=()
  case $before in
    --isolation) mapfile -t COMPREPLY < <(compgen -W 'process none' -- "$word"); return ;;
    --observe-group | --operate-group | --configure-group)
      mapfile -t COMPREPLY < <(compgen -g -- "$word"); return ;;
    --graph) mapfile -t COMPREPLY < <(compgen -W 'dot svg text' -- "$word"); return ;;
    --trace) mapfile -t COMPREPLY < <(compgen -f -- "$word"); return ;;
    --for | --seed | --quantum | --priority | --at | --watch | --every | --expect | --timeline) return ;;
  esac
  if [[ $word == -* || -z $command || $command == new ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_chimera_words "$command")" -- "$word")
  elif [[ $command == check || $command == run ]]; then
    mapfile -t COMPREPLY < <(compgen -f -X '!*.yaml' -- "$word"; compgen -d -- "$word")
  elif [[ $command == describe ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_chimera_components)" -- "$word")
  fi
}
complete -o filenames -F _chimera chimera
