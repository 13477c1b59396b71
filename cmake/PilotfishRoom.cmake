# A room is one folder of src/ with its public headers in include/pilotfish/<room>/, built as one static library.
# What a room may include is what it links here, so the calls in the top CMakeLists.txt ARE the architecture: an arrow
# that is not listed does not compile, because a target sees only the headers of the rooms it names.
#
#   pilotfish_room(vision ROOMS core LIBRARIES ... PRIVATE_LIBRARIES visp_core ...)
#
# To make that hold although all headers lie below one include/ folder, every room gets a folder of its own in the
# build tree, <build>/rooms/<room>/pilotfish/<room>, that links to its headers and nothing else.
function(pilotfish_room room)
  cmake_parse_arguments(arg "" "" "ROOMS;LIBRARIES;PRIVATE_LIBRARIES" ${ARGN})
  set(target pilotfish_${room})
  set(view ${CMAKE_BINARY_DIR}/rooms/${room})
  file(MAKE_DIRECTORY ${view}/pilotfish)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/include/pilotfish/${room} ${view}/pilotfish/${room} SYMBOLIC)
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${room}/*.cpp)
  list(TRANSFORM arg_ROOMS PREPEND pilotfish_)
  add_library(${target} STATIC ${sources})
  target_include_directories(${target} PUBLIC ${view} PRIVATE ${PROJECT_SOURCE_DIR}/src/${room})
  target_link_libraries(${target} PUBLIC ${arg_ROOMS} ${arg_LIBRARIES}
                                  PRIVATE ${arg_PRIVATE_LIBRARIES} pilotfish_warnings)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON LINKER_LANGUAGE CXX)
endfunction()

# Warnings for our own code only; third-party headers come in as SYSTEM.
add_library(pilotfish_warnings INTERFACE)
target_compile_options(pilotfish_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                                    -Wold-style-cast -Woverloaded-virtual)
if(PILOTFISH_WERROR)
  target_compile_options(pilotfish_warnings INTERFACE -Werror)
endif()
# A program needs only the libraries it really calls, although its rooms' static libraries could call more.
add_link_options(-Wl,--as-needed)
if(PILOTFISH_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-omit-frame-pointer -fno-sanitize-recover=undefined)
  add_link_options(-fsanitize=address,undefined)
endif()
if(PILOTFISH_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "PILOTFISH_FUZZ needs clang: -D CMAKE_C_COMPILER=clang -D CMAKE_CXX_COMPILER=clang++")
  endif()
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-omit-frame-pointer
                      -fno-sanitize-recover=undefined)
  add_link_options(-fsanitize=address,undefined)
endif()
