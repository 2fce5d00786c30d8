# Writes what describes the program's commands and options elsewhere, all of it from what its --help says: a manual page and
# completions for bash and zsh.
#   cmake -DPROGRAM=lumbrical -DVERSION=1.2.3 -DFOLDER=... -P program_texts.cmake
function(help_of out)
  execute_process(COMMAND ${PROGRAM} ${ARGN} --help OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  string(REPLACE ";" "," text "${text}")
  set(${out} "${text}" PARENT_SCOPE)
endfunction()

# A line's meaning hangs on nothing but what it begins with.
function(troff_of text out)
  string(REPLACE "\\" "\\e" text "${text}")
  string(REPLACE "-" "\\-" text "${text}")
  string(REGEX REPLACE "(^|\n)([.'])" "\\1\\\\&\\2" text "${text}")
  set(${out} "${text}" PARENT_SCOPE)
endfunction()

# The options of a help text as troff: "  --name FORM   What it is", which may begin on the line behind.
function(options_of text out)
  string(REGEX REPLACE "\n                              " "  " text "${text}")
  string(REGEX MATCHALL "\n  (  )?[^ \n][^\n]*" lines "${text}")
  set(result "")
  foreach(line IN LISTS lines)
    if(line MATCHES "^\n +([^ ].*[^ ])   *([^ ].*)$")
      troff_of("${CMAKE_MATCH_1}" name)
      troff_of("${CMAKE_MATCH_2}" what)
      string(APPEND result ".TP\n.B ${name}\n${what}\n")
    endif()
  endforeach()
  set(${out} "${result}" PARENT_SCOPE)
endfunction()

help_of(top)
string(REGEX REPLACE "^([^\n]*)\n.*" "\\1" purpose "${top}")
string(REGEX REPLACE ".*\n\n([^\n]+)\n*$" "\\1" closing "${top}")
string(REGEX REPLACE ".*\nSubcommands:" "" subcommands "${top}")
string(REGEX MATCHALL "\n  [a-z][a-z-]+ " commands "${subcommands}")
list(TRANSFORM commands STRIP)
list(LENGTH commands count)
if(count LESS 10)
  message(FATAL_ERROR "${PROGRAM} --help no longer lists its subcommands as this script reads them")
endif()
list(JOIN commands " " all_commands)
troff_of("${purpose}" purpose)
troff_of("${closing}" closing)
set(page ".TH LUMBRICAL 1 \"\" \"lumbrical ${VERSION}\" \"User Commands\"\n.SH NAME\nlumbrical \\- haptic rendering of the whole human hand\n")
string(APPEND page ".SH SYNOPSIS\n.B lumbrical\n.I COMMAND\n[\\fIOPTIONS\\fR]\n.SH DESCRIPTION\n${purpose}\n.PP\n${closing}\n")
set(cases "")
foreach(command IN LISTS commands)
  help_of(text ${command})
  string(REGEX REPLACE "^([^\n]*)\nUsage: ([^\n]*)\n.*" "\\1;\\2" head "${text}")
  list(GET head 0 what)
  list(GET head 1 usage)
  troff_of("${what}" what)
  troff_of("${usage}" usage)
  options_of("${text}" options)
  string(TOUPPER ${command} title)
  troff_of("${title}" title)
  string(APPEND page ".SH ${title}\n${what}\n.PP\n.B ${usage}\n${options}")
  string(REGEX MATCHALL "\n  (  )?(-[a-z],)?--[a-z-]+" switches "${text}")  # four blanks: of a group
  list(TRANSFORM switches REPLACE "^\n +(-[a-z],)?" "")
  list(JOIN switches " " switches)
  set(values "")  # of those options that take one of some
  string(REGEX MATCHALL "\n  --[a-z-]+ [a-z0-9_|-]+" choices "${text}")
  foreach(choice IN LISTS choices)
    string(REGEX MATCH "(--[a-z-]+) (.*)" choice "${choice}")
    set(switch ${CMAKE_MATCH_1})
    string(REPLACE "|" " " words "${CMAKE_MATCH_2}")
    if(words MATCHES " ")
      string(APPEND values "        ${command}:${switch}) words='${words}' ;;\n")
    endif()
  endforeach()
  string(APPEND cases "      ${command}) words='${switches}' ;;\n")
  string(APPEND all_values "${values}")
endforeach()
file(WRITE ${FOLDER}/lumbrical.1 "${page}")
set(body "_lumbrical() {
  local current=\${COMP_WORDS[COMP_CWORD]} words=''
  if [[ $COMP_CWORD == 1 && $current == -* ]]; then
    words='--help --version'
  elif [[ $COMP_CWORD == 1 ]]; then
    words='${all_commands}'
  else
    case \${COMP_WORDS[1]}:\${COMP_WORDS[COMP_CWORD - 1]} in
${all_values}    esac
    if [[ -z $words && $current == -* ]]; then
      case \${COMP_WORDS[1]} in
${cases}      esac
    fi
  fi
  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))
}
")
file(WRITE ${FOLDER}/lumbrical.bash "# Made of the program's own --help.\n${body}complete -o default -F _lumbrical lumbrical\n")
file(WRITE ${FOLDER}/_lumbrical "#compdef lumbrical\n# Made of the program's own --help.\nautoload -U +X bashcompinit && bashcompinit\n${body}complete -o default -F _lumbrical lumbrical\n")
