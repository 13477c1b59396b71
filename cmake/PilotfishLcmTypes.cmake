# From lcmtypes/*.lcm at build time: C++ headers (target pilotfish_lcmtypes), Python modules (pilotfish.lcmtypes.<package>)
# and the jar that makes lcm-spy show decoded fields. A file is named <package>_<type>.lcm, as everywhere in LCM's world.
#
# Two lcm-gens: C++ and Java must fit the system's liblcm and lcm.jar, so the system's makes them; Python types come from
# the one in the `lcm` wheel, because Python tools of LCM 1.5 need fields that 1.3's does not write. The wire is the same.
file(GLOB lcm_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/lcmtypes/*.lcm)
set(generated ${PROJECT_BINARY_DIR}/lcmtypes)
find_program(LCM_GEN lcm-gen PATHS /usr/bin NO_DEFAULT_PATH DOC "lcm-gen for C++ and Java")
find_program(LCM_GEN lcm-gen REQUIRED)

set(cpp_headers)
set(python_modules)
foreach(lcm_file ${lcm_files})
  get_filename_component(name ${lcm_file} NAME_WE)
  string(REGEX MATCH "^(bot_core|pilotfish)_(.+)$" matched ${name})
  if(NOT matched)
    message(FATAL_ERROR "${lcm_file}: its name does not start with a package we know (bot_core_, pilotfish_)")
  endif()
  set(type ${CMAKE_MATCH_1}/${CMAKE_MATCH_2})
  list(APPEND cpp_headers ${generated}/cpp/${type}.hpp)
  list(APPEND python_modules ${generated}/python/pilotfish/lcmtypes/${type}.py)
  add_custom_command(OUTPUT ${generated}/cpp/${type}.hpp
    COMMAND ${LCM_GEN} --cpp --cpp-std c++11 --cpp-hpath ${generated}/cpp ${lcm_file}
    DEPENDS ${lcm_file} VERBATIM)
endforeach()

# --- C++ ---------------------------------------------------------------------------------------------------------
add_custom_target(pilotfish_lcmtypes_cpp DEPENDS ${cpp_headers})
add_library(pilotfish_lcmtypes INTERFACE)
target_include_directories(pilotfish_lcmtypes SYSTEM INTERFACE ${generated}/cpp)
add_dependencies(pilotfish_lcmtypes pilotfish_lcmtypes_cpp)
# liblcm reads and writes a double through a pointer to int64_t, which the language forbids: GCC 12 at -O2 then takes a field
# that has just been decoded for the zero it was initialised with.
target_compile_options(pilotfish_lcmtypes INTERFACE -fno-strict-aliasing)

# --- Python: pilotfish.lcmtypes.bot_core.image_t, pilotfish.lcmtypes.pilotfish.command_t, ... -------------------------
# The prefix keeps the wire's package `pilotfish` from colliding with ours; fingerprints do not depend on it.
if(PILOTFISH_PYTHON)
  find_package(Python REQUIRED COMPONENTS Interpreter Development.Module)
  execute_process(COMMAND ${Python_EXECUTABLE} -c "import lcm; print(lcm.LCM_BIN_DIR)"
                  OUTPUT_VARIABLE lcm_wheel_bin OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  find_program(LCM_GEN_PYTHON lcm-gen PATHS "${lcm_wheel_bin}" NO_DEFAULT_PATH DOC "lcm-gen of the PyPI wheel")
  if(NOT LCM_GEN_PYTHON)
    message(FATAL_ERROR "no PyPI package `lcm` in ${Python_EXECUTABLE}: run scripts/setup, then "
                        "cmake --preset release -D Python_EXECUTABLE=.venv/bin/python")
  endif()
  # One command for all of them: each run also adds its types to the packages' __init__.py, so they must not run in
  # parallel, and a removed type must leave.
  set(python_types ${generated}/python/pilotfish/lcmtypes)
  add_custom_command(OUTPUT ${python_modules} ${python_types}/__init__.py
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${python_types}
    COMMAND ${LCM_GEN_PYTHON} --python --ppath ${generated}/python --package-prefix pilotfish.lcmtypes ${lcm_files}
    DEPENDS ${lcm_files} VERBATIM)
  add_custom_target(pilotfish_lcmtypes_python ALL DEPENDS ${python_modules})
  file(MAKE_DIRECTORY ${python_types} ${PROJECT_BINARY_DIR}/python/pilotfish)
  file(CREATE_LINK ${python_types} ${PROJECT_BINARY_DIR}/python/pilotfish/lcmtypes SYMBOLIC)
  install(DIRECTORY ${python_types} DESTINATION pilotfish COMPONENT python PATTERN __pycache__ EXCLUDE)
endif()

if(NOT PILOTFISH_APPS)
  return()
endif()
# --- Java: a jar for lcm-spy (pilotfish-spy) --------------------------------------------------------------------------
find_package(Java COMPONENTS Development QUIET)
find_file(LCM_JAR lcm.jar PATHS /usr/share/java /usr/local/share/java DOC "LCM's Java library")
set(java_share_dir ${CMAKE_INSTALL_DATADIR}/pilotfish)
set(java_launcher_dir ${CMAKE_INSTALL_BINDIR})
if(SKBUILD)  # a wheel's data and scripts land in the environment's share/ and bin/
  set(java_share_dir ${SKBUILD_DATA_DIR}/share/pilotfish)
  set(java_launcher_dir ${SKBUILD_SCRIPTS_DIR})
endif()
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/apps)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/apps/pilotfish-spy ${PROJECT_BINARY_DIR}/apps/pilotfish-spy SYMBOLIC)
install(PROGRAMS ${PROJECT_SOURCE_DIR}/apps/pilotfish-spy DESTINATION ${java_launcher_dir})
if(Java_JAVAC_EXECUTABLE AND Java_JAR_EXECUTABLE AND LCM_JAR)
  set(jar_folder ${PROJECT_BINARY_DIR}/share/pilotfish)
  set(jars ${jar_folder}/pilotfish-lcmtypes.jar ${jar_folder}/pilotfish-spy.jar)
  set(make_jars ${PROJECT_SOURCE_DIR}/apps/spy/make_jars)
  file(GLOB_RECURSE plugin_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/apps/spy/*.java)
  add_custom_command(OUTPUT ${jars}
    COMMAND ${CMAKE_COMMAND} -E env JAVAC=${Java_JAVAC_EXECUTABLE} JAR=${Java_JAR_EXECUTABLE}
            ${make_jars} ${LCM_GEN} ${LCM_JAR} ${jar_folder}
    DEPENDS ${lcm_files} ${plugin_sources} ${make_jars} ${PROJECT_SOURCE_DIR}/data/fuzzy/coordination.yaml VERBATIM)
  add_custom_target(pilotfish_jars ALL DEPENDS ${jars})
  install(FILES ${jars} DESTINATION ${java_share_dir})
else()
  message(STATUS "No Java compiler or no lcm.jar (default-jdk-headless, liblcm-java): "
                 "pilotfish-spy will list the channels, but show neither decoded fields nor a robot's window")
endif()
