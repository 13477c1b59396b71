# Completion of Pilotfish's C++ programs in bash: the options that a program's own --help lists and the choices that it
# names, {a,b}; else files. As /usr/share/bash-completion/completions/PROGRAM it is loaded when PROGRAM is first
# completed. `pilotfish`, which is Python's, brings its own: pilotfish --install-completion

_pilotfish_program() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} help words
  COMPREPLY=()
  help=$("$1" --help 2>/dev/null)
  if [[ $before == --* ]]; then
    words=$(sed -nE "s/^ +(-[a-zA-Z], ?)?$before [A-Z]+:\{([^}]*)\}.*/\2/p" <<<"$help" | tr , ' ')
  fi
  if [[ -z $words && $word == -* ]]; then
    words=$(sed -nE 's/^ +((-[a-zA-Z], ?)?--[a-z][a-z0-9-]*).*/\1/p' <<<"$help" | tr , ' ')
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}

complete -o default -F _pilotfish_program pilotfish-coordinator pilotfish-base pilotfish-sim pilotfish-spy
