# Headers of others, parsed once for a group of targets with the same options (its level of optimisation, too), and not once for each of
# their sources: what Eigen, pybind11 or GoogleTest declares is most of what many sources take to compile (docs/decisions/0045).
#
#   pilotfish_precompile(<group> <target> [<header>...])     the group's first target says which headers
#
# Never our own: a change of one would build the whole group anew. A source still includes what it names: clang-tidy sees
# it without, and so does -D CMAKE_DISABLE_PRECOMPILE_HEADERS=ON. GCC alone, which allows a
# source to have macros of its own that do not matter to these headers; another compiler builds without.
function(pilotfish_precompile group target)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU" OR CMAKE_DISABLE_PRECOMPILE_HEADERS)
    return()
  endif()
  # Or CMake would define <target>_EXPORTS, which nobody reads, and the group could not share what is precompiled with it.
  set_target_properties(${target} PROPERTIES DEFINE_SYMBOL "")
  get_property(first GLOBAL PROPERTY pilotfish_precompiled_${group})
  if(first)
    target_precompile_headers(${target} REUSE_FROM ${first})
  else()
    target_precompile_headers(${target} PRIVATE ${ARGN})
    set_property(GLOBAL PROPERTY pilotfish_precompiled_${group} ${target})
  endif()
  if(CCACHE)
    target_compile_options(${target} PRIVATE -fpch-preprocess)  # or ccache does not see what was precompiled
  endif()
endfunction()

# ccache keeps what is compiled with precompiled headers only if it may take defines and the time for what they are; under
# its own name, by which clang's tools know that the compiler is the word behind it.
function(pilotfish_compile_with_ccache ccache)
  set(launcher ${PROJECT_BINARY_DIR}/launcher/ccache)
  file(WRITE ${launcher}.in "#!/bin/sh\n"
       "CCACHE_SLOPPINESS=\${CCACHE_SLOPPINESS:+$CCACHE_SLOPPINESS,}pch_defines,time_macros exec '${ccache}' \"$@\"\n")
  configure_file(${launcher}.in ${launcher} COPYONLY
                 FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${launcher} PARENT_SCOPE)
endfunction()
