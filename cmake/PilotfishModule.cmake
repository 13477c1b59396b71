# A module is one folder of src/ with its public headers in include/pilotfish/<module>/, built as one library: target
# pilotfish_<module>, for others pilotfish::<module>, and a component of the installed package.
#
#   pilotfish_module(vision MODULES core PUBLIC eigen PRIVATE apriltag)     what it may include and link
#   ...
#   pilotfish_build_modules("fuzzy;vision")                                 those, and what they stand on
#
# OPTIONAL visp: src/<module>/visp/ is built, with PILOTFISH_WITH_VISP defined, where the module visp is built too.
#
# PUBLIC and PRIVATE are names from PilotfishDependencies.cmake; what no wanted module needs is not looked for.
#
# What a module may include is what it links here, so the calls in the top CMakeLists.txt ARE the architecture: an arrow
# that is not listed does not compile, because a target sees only the headers of the modules it names. To make that hold
# although all headers lie below one include/ folder, every module gets a folder of its own in the build tree,
# <build>/modules/<module>/pilotfish/<module>, that links to its headers and nothing else.
include(PilotfishDependencies)
set(pilotfish_precompiled_headers <algorithm> <array> <cmath> <cstdint> <cstring> <filesystem> <functional> <map> <memory>
    <optional> <set> <sstream> <string> <string_view> <utility> <variant> <vector>
    <Eigen/Core> <Eigen/Geometry> <Eigen/LU> <Eigen/Cholesky>)
set(pilotfish_debug_postfix d)  # so that both kinds of build can be installed into one place

function(pilotfish_module module)
  cmake_parse_arguments(arg "" "" "MODULES;PUBLIC;PRIVATE;OPTIONAL" ${ARGN})
  foreach(kind IN ITEMS MODULES PUBLIC PRIVATE OPTIONAL)
    set_property(GLOBAL PROPERTY pilotfish_${module}_${kind} "${arg_${kind}}")
  endforeach()
  set_property(GLOBAL APPEND PROPERTY pilotfish_modules ${module})
endfunction()

# A macro: the targets of what is found belong to the caller's folder.
macro(pilotfish_build_modules wanted)
  pilotfish_closure("${wanted}" PILOTFISH_MODULES)
  pilotfish_settle_options("${PILOTFISH_MODULES}")
  foreach(module IN LISTS PILOTFISH_MODULES)
    foreach(kind IN ITEMS PUBLIC PRIVATE)
      get_property(names GLOBAL PROPERTY pilotfish_${module}_${kind})
      foreach(name IN LISTS names)
        pilotfish_require(${name} "module ${module}")
      endforeach()
    endforeach()
  endforeach()
  if("bus" IN_LIST PILOTFISH_MODULES OR "blackbox" IN_LIST PILOTFISH_MODULES)
    include(PilotfishLcmTypes)
  endif()
  foreach(module IN LISTS PILOTFISH_MODULES)
    pilotfish_add_library(${module})
  endforeach()
endmacro()

# What is optional becomes private where the module of its name is built too.
function(pilotfish_settle_options modules)
  foreach(module IN LISTS modules)
    get_property(names GLOBAL PROPERTY pilotfish_${module}_OPTIONAL)
    foreach(name IN LISTS names)
      if(name IN_LIST modules)
        set_property(GLOBAL APPEND PROPERTY pilotfish_${module}_PRIVATE ${name})
      endif()
    endforeach()
  endforeach()
endfunction()

macro(pilotfish_require name for)
  set(pilotfish_missing)
  pilotfish_depend(${name} ${for})
  if(pilotfish_missing)
    pilotfish_modules_without(${name} pilotfish_others)
    if(pilotfish_others AND "${for}" MATCHES "^module ")
      string(APPEND pilotfish_missing "\nThese modules do without it, name those you want: "
                                      "-D PILOTFISH_COMPONENTS=\"${pilotfish_others}\" (docs/library.md)")
    endif()
    message(FATAL_ERROR "${pilotfish_missing}")
  endif()
endmacro()

# The modules that need no dependency of that name, neither for themselves nor for those they stand on. What is optional
# comes only where it is asked for.
function(pilotfish_modules_without name result)
  set(others)
  get_property(modules GLOBAL PROPERTY pilotfish_modules)
  foreach(module IN LISTS modules)
    get_property(below GLOBAL PROPERTY pilotfish_${module}_MODULES)
    set(without TRUE)
    get_property(optional GLOBAL PROPERTY pilotfish_${module}_OPTIONAL)
    foreach(kind IN ITEMS PUBLIC PRIVATE)
      get_property(needs GLOBAL PROPERTY pilotfish_${module}_${kind})
      foreach(need IN LISTS needs)
        if(NOT need IN_LIST optional AND pilotfish_package_${need} STREQUAL pilotfish_package_${name})
          set(without FALSE)
        endif()
      endforeach()
    endforeach()
    foreach(each IN LISTS below)  # declared before
      if(NOT each IN_LIST others)
        set(without FALSE)
      endif()
    endforeach()
    if(without)
      list(APPEND others ${module})
    endif()
  endforeach()
  set(${result} "${others}" PARENT_SCOPE)
endfunction()

# What is built besides the modules needs them: said here, instead of by the compiler.
function(pilotfish_needs_modules option what)
  set(absent ${ARGN})
  list(REMOVE_ITEM absent ${PILOTFISH_MODULES})
  if(${option} AND absent)
    message(FATAL_ERROR "${what} (${option}) need modules that PILOTFISH_COMPONENTS leaves out: ${absent}\n"
                        "Leave out -D ${option}=ON, or -D PILOTFISH_COMPONENTS")
  endif()
endfunction()

# The wanted modules and those they stand on, in the order of their declaration.
function(pilotfish_closure wanted result)
  if(NOT wanted)
    message(FATAL_ERROR "PILOTFISH_COMPONENTS names no module; leave it out for all of them")
  endif()
  get_property(modules GLOBAL PROPERTY pilotfish_modules)
  foreach(module IN LISTS wanted)
    if(NOT module IN_LIST modules)
      list(JOIN modules ", " there_is)
      set(hint)
      if(module MATCHES ",")
        set(hint " (names are separated by semicolons: \"fuzzy;vision\")")
      endif()
      message(FATAL_ERROR "PILOTFISH_COMPONENTS: there is no '${module}'${hint}; choose from ${there_is}")
    endif()
  endforeach()
  set(closure)  # a list of that name may be in the scope of a project that includes this one; so below
  list(REVERSE modules)
  foreach(module IN LISTS modules)
    if(module IN_LIST wanted)
      get_property(below GLOBAL PROPERTY pilotfish_${module}_MODULES)
      list(APPEND wanted ${below})
      list(PREPEND closure ${module})
    endif()
  endforeach()
  set(${result} ${closure} PARENT_SCOPE)
endfunction()

function(pilotfish_targets_of names result)
  set(targets)
  foreach(name IN LISTS names)
    list(APPEND targets ${pilotfish_targets_${name}})
  endforeach()
  set(${result} ${targets} PARENT_SCOPE)
endfunction()

function(pilotfish_add_library module)
  foreach(kind IN ITEMS MODULES PUBLIC PRIVATE)
    get_property(${kind} GLOBAL PROPERTY pilotfish_${module}_${kind})
  endforeach()
  set(target pilotfish_${module})
  set(view ${PROJECT_BINARY_DIR}/modules/${module})
  file(MAKE_DIRECTORY ${view}/pilotfish)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/include/pilotfish/${module} ${view}/pilotfish/${module} SYMBOLIC)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/include/pilotfish/api.hpp ${view}/pilotfish/api.hpp SYMBOLIC)
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${module}/*.cpp)
  get_property(options GLOBAL PROPERTY pilotfish_${module}_OPTIONAL)
  set(definitions)
  foreach(name IN LISTS options)
    if(name IN_LIST PRIVATE)
      file(GLOB more CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${module}/${name}/*.cpp)
      list(APPEND sources ${more})
      string(TOUPPER PILOTFISH_WITH_${name} definition)
      list(APPEND definitions ${definition})
    endif()
  endforeach()
  pilotfish_targets_of("${PUBLIC}" public_targets)
  pilotfish_targets_of("${PRIVATE}" private_targets)
  set(below ${MODULES})
  list(TRANSFORM below PREPEND pilotfish_)
  add_library(${target} ${sources})
  target_compile_definitions(${target} PRIVATE ${definitions})
  add_library(pilotfish::${module} ALIAS ${target})
  target_compile_features(${target} PUBLIC cxx_std_17)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${view}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
                                       PRIVATE ${PROJECT_SOURCE_DIR}/src/${module})
  target_link_libraries(${target} PUBLIC ${below} ${public_targets}
                                  PRIVATE ${private_targets} $<BUILD_INTERFACE:pilotfish_warnings>)
  if("lcm" IN_LIST PRIVATE)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:pilotfish_lcmtypes>)
  endif()
  # A part of a unity build, where one is asked for, shall compile within 20 seconds; the sources of vision are heavy.
  if(module STREQUAL "vision")
    set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE 2)
  endif()
  # Before 1.0 every minor version may change the interface, so the name of the shared library carries it.
  # Shared, they find each other in the folder that they are installed in.
  set_target_properties(${target} PROPERTIES
    INSTALL_RPATH "$ORIGIN"
    POSITION_INDEPENDENT_CODE ON LINKER_LANGUAGE CXX EXPORT_NAME ${module}
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON DEBUG_POSTFIX "${pilotfish_debug_postfix}"
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  if("lcm" IN_LIST PRIVATE)  # its options are others
    pilotfish_precompile(modules_with_lcm ${target} ${pilotfish_precompiled_headers})
  elseif(module STREQUAL "core" OR MODULES)  # core has Eigen, and so has what stands on it
    pilotfish_precompile(modules ${target} ${pilotfish_precompiled_headers})
  endif()
endfunction()

# Warnings for our own code only; third-party headers come in as SYSTEM.
add_library(pilotfish_warnings INTERFACE)
target_compile_options(pilotfish_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                                    -Wold-style-cast -Woverloaded-virtual)
if(PILOTFISH_WERROR)
  target_compile_options(pilotfish_warnings INTERFACE -Werror)
endif()
# A program needs only the libraries it really calls, although its modules' static libraries could call more.
add_link_options(-Wl,--as-needed)
if(PILOTFISH_SANITIZE)
  # GCC takes its own checks of std::regex for reads of what nobody wrote.
  add_compile_options(-Wno-maybe-uninitialized)
  add_compile_options(-fsanitize=address,undefined -fno-omit-frame-pointer -fno-sanitize-recover=undefined)
  add_link_options(-fsanitize=address,undefined)
endif()
if(PILOTFISH_SANITIZE_THREADS)
  if(PILOTFISH_SANITIZE)
    message(FATAL_ERROR "PILOTFISH_SANITIZE and PILOTFISH_SANITIZE_THREADS exclude each other: a compiler does one at a time")
  endif()
  add_compile_options(-fsanitize=thread -fno-omit-frame-pointer)
  add_link_options(-fsanitize=thread)
endif()
if(PILOTFISH_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "PILOTFISH_FUZZ needs clang: -D CMAKE_C_COMPILER=clang -D CMAKE_CXX_COMPILER=clang++")
  endif()
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-omit-frame-pointer
                      -fno-sanitize-recover=undefined)
  add_link_options(-fsanitize=address,undefined)
endif()
