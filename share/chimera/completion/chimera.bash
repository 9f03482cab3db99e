# SPDX-License-Identifier: Apache-2.0
# Completion of `chimera` for bash: installed as share/bash-completion/completions/chimera.
# tests/install/words.py holds it and the manual against `chimera --help`.

# The options of each command, and at the top level the commands too.
_chimera_words() {
  case $1 in
    '') echo '--help --version check schedule run sweep idle list describe test new clear end events flag get kill off on' \
      'profile reinit ring save scope set spawn status top watch why shell' ;;
    check) echo '--help --json --set --graph' ;;
    schedule) echo '--help --set --profile --svg --dispatch --json' ;;
    run) echo '--help --for --start-limit --set --at --watch --every --svg --expect --strict --trace --profile --timeline --virtual' \
      '--preemptive --seed --quantum --priority --may-miss --isolation --observe-group --operate-group --configure-group --json' ;;
    sweep) echo '--help --over --for --measure --expect --set --at --every --jobs --limit --preemptive --seed' \
      '--quantum --csv --svg --json' ;;
    idle) echo '--help --subsystem' ;;
    list) echo '--help --json' ;;
    describe) echo '--help --json' ;;
    test) echo '--help --all --setup --inputs --names --seed --cycles --case --junit --jobs --limit --json' ;;
    clear | end | flag | kill | off | on | reinit | ring | set | spawn | why)
      echo '--help --json --subsystem' ;;
    status) echo '--help --json --subsystem --pid' ;;
    events) echo '--help --json --subsystem --since --kind --each --follow' ;;
    get) echo '--help --json --subsystem --every' ;;
    profile) echo '--help --json --subsystem --save' ;;
    save) echo '--help --json --subsystem --write' ;;
    scope) echo '--help --json --subsystem --trigger --pre --for --wait --csv --svg' ;;
    top) echo '--help --json --subsystem --every' ;;
    watch) echo '--help --json --subsystem --every' ;;
    shell) echo '--help --keep-going --subsystem' ;;
    new) echo '--help component app' ;;
    'new component') echo '--help --c --hardware' ;;
    'new app') echo '--help' ;;
  esac
}

_chimera_components() {
  "${COMP_WORDS[0]}" list --json 2>/dev/null | grep -o '"name": "[^"]*"' | cut -d '"' -f 4
}

# Variables and tasks of the running subsystem.
_chimera_names() {
  "${COMP_WORDS[0]}" get --json 2>/dev/null | grep -o '"[a-z][a-z0-9_]*":{' | cut -d '"' -f 2 | grep -v '^values*$'
}
_chimera_tasks() {
  "${COMP_WORDS[0]}" status --json 2>/dev/null | grep -o '"task":"[^"]*"' | cut -d '"' -f 4
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
    --dispatch) mapfile -t COMPREPLY < <(compgen -W 'preemptive executive' -- "$word"); return ;;
    --graph) mapfile -t COMPREPLY < <(compgen -W 'dot svg text' -- "$word"); return ;;
    --trace | --csv | --svg | --profile | --save | --setup | --inputs | --junit)
      mapfile -t COMPREPLY < <(compgen -f -- "$word"); return ;;
    --names | --cycles | --for | --seed | --quantum | --priority | --set | --at | --watch | --every | --expect | \
      --timeline | --over | --measure | --jobs | --limit | --case | --since | --kind | --trigger | --pre | --wait | \
      --subsystem) return ;;
  esac
  if [[ $word == -* || -z $command || $command == new ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_chimera_words "$command")" -- "$word")
  elif [[ $command == check || $command == schedule || $command == run || $command == sweep ]]; then
    mapfile -t COMPREPLY < <(compgen -f -X '!*.yaml' -- "$word"; compgen -d -- "$word")
  elif [[ " get set watch why scope " == *" $command "* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_chimera_names)" -- "$word")
  elif [[ " on off kill clear reinit ring spawn " == *" $command "* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_chimera_tasks)" -- "$word")
  elif [[ $command == flag ]]; then
    mapfile -t COMPREPLY < <(compgen -W 'up down' -- "$word")
  elif [[ $command == shell ]]; then
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  elif [[ $command == describe ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_chimera_components)" -- "$word")
  elif [[ $command == test ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_chimera_components)" -- "$word"; compgen -f -X '!*.so' -- "$word"; compgen -d -- "$word")
  fi
}
complete -o filenames -F _chimera chimera
